#include "server/place_recognition/place_recognition_options.h"

#include "common/base/range_check.h"

namespace pangaea {

Status PlaceCandidateOptions::Check() const {
  if (const Status status = query.Check(); !status) return status;
  return RangeCheck("place candidates")
      .In("places", places, 1, 100)
      .In("min_shared", min_shared, 1, RangeCheck::kUnlimited)
      .status();
}

Status PlaceGeometryOptions::Check() const {
  // A similarity has seven unknowns and a pair gives four numbers or more: with four pairs something can be judged.
  return RangeCheck("place geometry")
      .In("covisible", covisible, 0, 100)
      .In("noise.pixel_sigma", noise.pixel_sigma, 0.01, 100.0)
      .In("noise.max_depth_baselines", noise.max_depth_baselines, 1.0, RangeCheck::kUnlimited)
      .In("matching.max_distance", matching.max_distance, 0, 256)
      .In("matching.max_ratio", matching.max_ratio, 0.01, 1.0)
      .In("min_own_matches", min_own_matches, 0, RangeCheck::kUnlimited)
      .In("min_matches", min_matches, 4, RangeCheck::kUnlimited)
      .In("ransac_iterations", ransac_iterations, 1, 100000)
      .In("ransac_sigmas", ransac_sigmas, 0.1, 1000.0)
      .In("min_aligned", min_aligned, 4, RangeCheck::kUnlimited)
      .In("narrow_radius", narrow_radius, 0.1, 1000.0)
      .In("wide_radius", wide_radius, narrow_radius, 1000.0)
      .In("octave_tolerance", octave_tolerance, 0, kOctaves)
      .In("max_view_angle", max_view_angle, 1.0, 179.0)
      .In("guided_matching.max_distance", guided_matching.max_distance, 0, 256)
      .In("guided_matching.max_ratio", guided_matching.max_ratio, 0.01, 1.0)
      .In("min_guided", min_guided, 4, RangeCheck::kUnlimited)
      .In("min_inliers", min_inliers, 4, RangeCheck::kUnlimited)
      .status();
}

Status PlaceAgreementOptions::Check() const {
  return RangeCheck("place agreement")
      .In("keyframes", keyframes, 1, 100)
      .In("covisible", covisible, 0, 100)
      .In("window", window, 1, 10000)
      .In("lookalikes", lookalikes, 1, 100)
      .In("max_axis_angle", max_axis_angle, 1.0, 180.0)
      .In("radius", radius, 0.1, 1000.0)
      .In("min_cell_share", min_cell_share, 0.0, 1.0)
      .In("contradicting_cell_share", contradicting_cell_share, 0.0, min_cell_share)
      .status();
}

Status PlaceRecognitionOptions::Check() const {
  if (const Status status = candidates.Check(); !status) return status;
  if (const Status status = geometry.Check(); !status) return status;
  return agreement.Check();
}

}  // namespace pangaea
