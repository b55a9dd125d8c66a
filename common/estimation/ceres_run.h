#pragma once

#include <ceres/iteration_callback.h>

#include <stop_token>

namespace pangaea {

// Ends a Ceres run after the step in which a stop was requested; the best state so far stays.
class CeresStopCallback final : public ceres::IterationCallback {
 public:
  explicit CeresStopCallback(std::stop_token stop) : stop_(std::move(stop)) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override;
  bool stopped() const { return stopped_; }

 private:
  std::stop_token stop_;
  bool stopped_ = false;
};

// Ceres warns on stderr of every step whose factorisation failed; it recovers from those by itself. Call before a run.
void SilenceCeresWarnings();

}  // namespace pangaea
