#include "agent/mapping/local_mapping_options.h"

#include <string_view>

#include "common/base/range_check.h"

namespace pangaea {
namespace {

constexpr double kUnlimited = RangeCheck::kUnlimited;
constexpr std::size_t kMostWideKeyframes = 5000;

void CheckNeighbourhood(const NeighbourhoodOptions& neighbourhood, RangeCheck& check) {
  check.In("neighbourhood.first", neighbourhood.first, 1, 1000)
      .In("neighbourhood.second_of_each", neighbourhood.second_of_each, 0, 1000)
      .In("neighbourhood.overlapping", neighbourhood.overlapping, 0, 1000)
      .In("neighbourhood.max_axis_angle", neighbourhood.max_axis_angle, 0, 180)
      .In("neighbourhood.min_overlap", neighbourhood.min_overlap, 0, 1)
      .In("neighbourhood.overlap_samples", neighbourhood.overlap_samples, 1, 10000);
}

void CheckSearch(const LandmarkSearchOptions& search, RangeCheck& check) {
  check.In("search.radius", search.radius, 0.5, 100)
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

Status CheckAdjustment(std::string_view owner, const LocalBundleAdjustmentOptions& adjustment, std::size_t most) {
  RangeCheck check(owner);
  check.In("bundle_adjustment.window_keyframes", adjustment.window_keyframes, 1, static_cast<double>(most))
      .In("bundle_adjustment.fixed_keyframes", adjustment.fixed_keyframes, 1, 10000)
      .In("bundle_adjustment.iterations", adjustment.iterations, 1, 1000)
      .In("bundle_adjustment.iterations_without_outliers", adjustment.iterations_without_outliers, 0, 1000)
      .In("bundle_adjustment.iterations_together", adjustment.iterations_together, 0, 1000)
      .In("bundle_adjustment.cost_tolerance", adjustment.cost_tolerance, 0, 1);
  return check.status().and_then([&] { return adjustment.visits ? adjustment.visits->Check() : Status(); });
}

void CheckWideAdjustment(const WideAdjustmentOptions& wide, RangeCheck& check) {
  check.In("wide_adjustment.max_strain", wide.max_strain, 0, 1)
      .In("wide_adjustment.max_outliers", wide.max_outliers, 0, 1)
      .In("wide_adjustment.strain_samples", wide.strain_samples, 1, 100000)
      .In("wide_adjustment.min_gap", wide.min_gap, 1, 100000)
      .In("wide_adjustment.min_growth", wide.min_growth, 0, 100);
}

void CheckVergence(const VergenceOptions& vergence, RangeCheck& check) {
  check.In("vergence.first_keyframes", vergence.first_keyframes, 3, 100000)
      .In("vergence.second_look_keyframes", vergence.second_look_keyframes, 1, 100000)
      .In("vergence.window_keyframes", vergence.window_keyframes, 3, kDenseKeyframes)
      .In("vergence.min_shift", vergence.min_shift, 0, 100)
      .In("vergence.min_lone_shift", vergence.min_lone_shift, 0, 100)
      .In("vergence.min_sure_shift", vergence.min_sure_shift, 0, 100)
      .In("vergence.min_sigmas", vergence.min_sigmas, 0, 100)
      .In("vergence.iterations", vergence.iterations, 1, 1000)
      .In("vergence.cost_tolerance", vergence.cost_tolerance, 0, 1);
}

}  // namespace

Status LocalMappingOptions::Check() const {
  RangeCheck check("local mapping");
  check.In("noise.pixel_sigma", noise.pixel_sigma, 0.01, 100);
  check.In("noise.max_depth_baselines", noise.max_depth_baselines, 1, 10000);
  CheckNeighbourhood(neighbourhood, check);
  CheckSearch(search, check);
  CheckCreation(creation, check);
  CheckCulling(*this, check);
  CheckWideAdjustment(wide_adjustment, check);
  CheckVergence(vergence, check);
  if (!check.status()) return check.status();
  if (auto status = CheckAdjustment("local mapping", bundle_adjustment, kDenseKeyframes); !status) return status;
  return CheckAdjustment("local mapping: wide_adjustment", wide_adjustment.bundle_adjustment, kMostWideKeyframes);
}

}  // namespace pangaea
