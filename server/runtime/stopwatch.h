#pragma once

#include <time.h>

#include <chrono>
#include <cstdint>

namespace pangaea {

// Measures from its construction on, by the wall clock and by the processor time of the thread that made it.
class Stopwatch {
 public:
  double milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin_).count();
  }
  // On the thread that made it.
  double cpu_milliseconds() const { return 1e-6 * static_cast<double>(ThreadNanoseconds() - cpu_begin_ns_); }

 private:
  static std::int64_t ThreadNanoseconds() {
    timespec time{};
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1'000'000'000 * static_cast<std::int64_t>(time.tv_sec) + time.tv_nsec;
  }

  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::int64_t cpu_begin_ns_ = ThreadNanoseconds();
};

}  // namespace pangaea
