#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/stage_recorder.h"

namespace pangaea {

// Durations of one stage of the work.
struct StageStatistics {
  std::size_t count = 0;
  double median_ms = 0.0;
  double mean_ms = 0.0;
  double p95_ms = 0.0;
};

// Measures stages by the wall clock. Decoding of images is measured apart: a stage that calls for it is not charged.
// One owner thread.
class StageClock final : public StageRecorder {
 public:
  static constexpr std::string_view kDecode = "decode";

  void Begin(std::string_view name) override;
  void End(std::string_view name) override;

  // Takes over the durations of another thread's clock.
  void Add(const StageClock& other);
  std::map<std::string, StageStatistics> Statistics() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Open {
    std::string_view name;
    Clock::time_point begin;
    Clock::duration decoding{};
  };

  std::vector<Open> open_;  // innermost last
  std::map<std::string, std::vector<float>, std::less<>> milliseconds_;
};

}  // namespace pangaea
