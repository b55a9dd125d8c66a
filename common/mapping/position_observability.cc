#include "common/mapping/position_observability.h"

namespace pangaea {

Status ObservabilityOptions::Check() const {
  if (max_sigma_m > 0.0 && max_sigma_of_depth > 0.0) return {};
  return Fail(ErrorCode::kInvalidArgument,
              "tracking: max_position_sigma_m and max_position_sigma_of_depth must be greater than 0");
}

bool PositionIsObservable(const RefinedPose& pose, double median_depth, bool metric,
                          const ObservabilityOptions& options) {
  const double sigma = TranslationSigmas(pose.information).maxCoeff();
  return sigma < (metric ? options.max_sigma_m : options.max_sigma_of_depth * median_depth);
}

}  // namespace pangaea
