#pragma once

#include <chrono>
#include <cstdint>

namespace pangaea {

// The system clock, nanoseconds since 1970.
inline std::int64_t UnixNanoseconds() {
  using std::chrono::duration_cast, std::chrono::nanoseconds, std::chrono::system_clock;
  return duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count();
}

}  // namespace pangaea
