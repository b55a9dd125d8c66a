#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/keypoint.h"

namespace pangaea {

// Keypoints in square buckets, for queries by window. Refers to the keypoints given at construction: they must outlive
// it unchanged. Immutable, so any number of threads may query it.
class FeatureGrid {
 public:
  FeatureGrid() = default;
  explicit FeatureGrid(std::span<const Keypoint> keypoints);

  // Calls visit(index) for each keypoint within `radius` pixels of (u, v) in both coordinates and with min_octave <=
  // octave <= max_octave; bucket by bucket, in ascending order within each.
  template <typename Visit>
  void ForEachInWindow(float u, float v, float radius, int min_octave, int max_octave, Visit&& visit) const {
    if (keypoints_.empty() || !(radius >= 0.0F)) return;
    const int first_column = Column(u - radius);
    const int last_column = Column(u + radius);
    const int last_row = Row(v + radius);
    for (int row = Row(v - radius); row <= last_row; ++row) {
      const std::uint32_t begin = starts_[BucketIndex(first_column, row)];
      const std::uint32_t end = starts_[BucketIndex(last_column, row) + 1];  // buckets of a row follow each other
      for (std::uint32_t i = begin; i < end; ++i) {
        const Keypoint& keypoint = keypoints_[order_[i]];
        if (keypoint.octave < min_octave || keypoint.octave > max_octave) continue;
        if (keypoint.u < u - radius || keypoint.u > u + radius) continue;
        if (keypoint.v < v - radius || keypoint.v > v + radius) continue;
        visit(order_[i]);
      }
    }
  }

  std::span<const Keypoint> keypoints() const { return keypoints_; }

 private:
  // Clamped to the grid: what lies outside of it is in, or looked for in, the outermost buckets.
  int Column(float u) const;
  int Row(float v) const;
  std::size_t BucketIndex(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }

  std::span<const Keypoint> keypoints_;
  float left_ = 0.0F;  // smallest u and v of all keypoints
  float top_ = 0.0F;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint32_t> starts_;  // per bucket its begin in order_; one more at the end
  std::vector<std::uint32_t> order_;   // keypoint indices, bucket by bucket
};

}  // namespace pangaea
