#include "common/estimation/ceres_run.h"

#include <glog/logging.h>

#include <algorithm>

namespace pangaea {

ceres::CallbackReturnType CeresStopCallback::operator()(const ceres::IterationSummary& summary) {
  // Iteration 0 is the evaluation of the start.
  const bool stop = summary.iteration > 0 && stop_.stop_requested();
  stopped_ = stopped_ || stop;
  return stop ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
}

void SilenceCeresWarnings() {
  static const bool once = [] {
    FLAGS_minloglevel = std::max(FLAGS_minloglevel, static_cast<int>(google::GLOG_ERROR));
    return true;
  }();
  static_cast<void>(once);
}

}  // namespace pangaea
