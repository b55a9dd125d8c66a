#include "server/fusion/fusion_options.h"

#include "common/base/range_check.h"

namespace pangaea {

Status FusionOptions::Check() const {
  RangeCheck check("fusion");
  check.In("noise.pixel_sigma", noise.pixel_sigma, 0.01, 100)
      .In("noise.max_depth_baselines", noise.max_depth_baselines, 1, 10000)
      .In("window.keyframes", window.keyframes, 1, 200)
      .In("window.searched", window.searched, 1, 200)
      .In("window.fixed_keyframes", window.fixed_keyframes, 0, 10000)
      .In("first_radius", first_radius, 0.5, 100)
      .In("second_radius", second_radius, 0.5, 100)
      .In("iterations", iterations, 1, 1000)
      .In("iterations_without_outliers", iterations_without_outliers, 0, 1000)
      .In("cost_tolerance", cost_tolerance, 0, 1)
      .In("judgement.min_common_landmarks", judgement.min_common_landmarks, 3, 100000)
      .In("judgement.min_inlier_share", judgement.min_inlier_share, 0, 1)
      .In("judgement.max_cost_growth", judgement.max_cost_growth, 1, 100)
      .In("judgement.noise_cost", judgement.noise_cost, 0, 100)
      .In("drift.translation_per_path", drift.translation_per_path, 0, 10)
      .In("drift.rotation_per_path", drift.rotation_per_path, 0, 180)
      .In("drift.scale_per_path", drift.scale_per_path, 0, 10)
      .In("drift.min_translation", drift.min_translation, 0, 100)
      .In("drift.min_rotation", drift.min_rotation, 0, 180)
      .In("drift.min_scale", drift.min_scale, 0, 10)
      .In("drift.min_shared_landmarks", drift.min_shared_landmarks, 1, 100000);
  return check.status();
}

}  // namespace pangaea
