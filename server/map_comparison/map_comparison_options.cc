#include "server/map_comparison/map_comparison_options.h"

#include "common/base/range_check.h"

namespace pangaea {

Status MapComparisonOptions::Check() const {
  return RangeCheck("map comparison")
      .In("min_observations", min_observations, 1, 1000)
      .In("max_landmarks", max_landmarks, 100, 100'000)
      .In("matching.max_distance", matching.max_distance, 0, 256)
      .In("matching.max_ratio", matching.max_ratio, 0.01, 1.0)
      .In("ransac_iterations", ransac_iterations, 1, 10'000'000)
      .In("tolerance", tolerance, 1e-4, 1.0)
      .In("cell", cell, tolerance, 100.0)
      .In("guided_distance", guided_distance, 0, 256)
      .In("min_pairs", min_pairs, 4, RangeCheck::kUnlimited)
      .In("min_cells", min_cells, 3, RangeCheck::kUnlimited)
      .In("min_lead", min_lead, 1.0, RangeCheck::kUnlimited)
      .In("min_overlap", min_overlap, 0.0, 1.0)
      .In("min_surface_share", min_surface_share, 0.0, 1.0)
      .In("surface_tolerance", surface_tolerance, 1e-4, 1.0)
      .status();
}

}  // namespace pangaea
