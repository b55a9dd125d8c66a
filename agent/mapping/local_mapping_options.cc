#include "agent/mapping/local_mapping_options.h"

#include <cmath>
#include <limits>
#include <sstream>

namespace pangaea {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::max();

// Collects the first option that is out of its range.
class RangeCheck {
 public:
  template <typename Number>
  RangeCheck& In(const char* name, Number value, double low, double high) {
    const double number = static_cast<double>(value);
    if (status_.has_value() && !(number >= low && number <= high)) {
      std::ostringstream message;
      message << "local mapping: " << name << " is " << number << ", allowed are " << low << " to ";
      if (high == kUnlimited) {
        message << "any number";
      } else {
        message << high;
      }
      status_ = Fail(ErrorCode::kInvalidArgument, message.str());
    }
    return *this;
  }
  const Status& status() const { return status_; }

 private:
  Status status_;
};

void CheckSearch(const LandmarkSearchOptions& search, RangeCheck& check) {
  check.In("search.neighbourhood.first", search.neighbourhood.first, 1, 1000)
      .In("search.neighbourhood.second_of_each", search.neighbourhood.second_of_each, 0, 1000)
      .In("search.neighbourhood.overlapping", search.neighbourhood.overlapping, 0, 1000)
      .In("search.neighbourhood.max_axis_angle", search.neighbourhood.max_axis_angle, 0, 180)
      .In("search.neighbourhood.min_overlap", search.neighbourhood.min_overlap, 0, 1)
      .In("search.neighbourhood.overlap_samples", search.neighbourhood.overlap_samples, 1, 10000)
      .In("search.radius", search.radius, 0.5, 100)
      .In("search.old_radius", search.old_radius, 0.5, 100)
      .In("search.fusion_gate", search.fusion_gate, 0.1, 100)
      .In("search.max_distance", search.max_distance, 0, 256)
      .In("search.max_ratio", search.max_ratio, 0, 1)
      .In("search.max_view_angle", search.max_view_angle, 0, 180)
      .In("search.octave_tolerance", search.octave_tolerance, 0, 7);
}

void CheckCreation(const LandmarkCreationOptions& creation, RangeCheck& check) {
  check.In("creation.close_depth_baselines", creation.close_depth_baselines, 1, kUnlimited)
      .In("creation.first_depth_baselines", creation.first_depth_baselines, 1, kUnlimited)
      .In("creation.min_parallax", creation.min_parallax, 0.01, 90)
      .In("creation.max_distance", creation.max_distance, 0, 256)
      .In("creation.max_ratio", creation.max_ratio, 0, 1)
      .In("creation.max_epipolar", creation.max_epipolar, 0.1, 100)
      .In("creation.max_scale_error", creation.max_scale_error, 1, 100);
}

void CheckCulling(const LocalMappingOptions& options, RangeCheck& check) {
  check.In("landmark_culling.first_verdict_chances", options.landmark_culling.first_verdict_chances, 1, 1000)
      .In("landmark_culling.trial_chances", options.landmark_culling.trial_chances, 1, 1000)
      .In("landmark_culling.max_keyframes", options.landmark_culling.max_keyframes, 1, 100000)
      .In("landmark_culling.min_found_ratio", options.landmark_culling.min_found_ratio, 0, 1)
      .In("keyframe_culling.redundant_ratio", options.keyframe_culling.redundant_ratio, 0, 1)
      .In("keyframe_culling.other_observers", options.keyframe_culling.other_observers, 1, 1000)
      .In("keyframe_culling.newest_kept", options.keyframe_culling.newest_kept, 1, 1000);
}

void CheckAdjustment(const LocalBundleAdjustmentOptions& adjustment, RangeCheck& check) {
  check.In("bundle_adjustment.window_keyframes", adjustment.window_keyframes, 1, 60)
      .In("bundle_adjustment.fixed_keyframes", adjustment.fixed_keyframes, 1, 10000)
      .In("bundle_adjustment.iterations", adjustment.iterations, 1, 1000)
      .In("bundle_adjustment.iterations_without_outliers", adjustment.iterations_without_outliers, 0, 1000);
}

}  // namespace

Status LocalMappingOptions::Check() const {
  RangeCheck check;
  check.In("noise.pixel_sigma", noise.pixel_sigma, 0.01, 100);
  check.In("noise.max_depth_baselines", noise.max_depth_baselines, 1, 10000);
  CheckSearch(search, check);
  CheckCreation(creation, check);
  CheckCulling(*this, check);
  CheckAdjustment(bundle_adjustment, check);
  return check.status();
}

}  // namespace pangaea
