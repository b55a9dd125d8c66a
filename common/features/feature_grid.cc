#include "common/features/feature_grid.h"

#include <algorithm>

namespace pangaea {
namespace {

constexpr float kBucketSize = 32.0F;  // pixels: about the usual search windows
constexpr int kMostBuckets = 1024;    // along an axis, whatever the coordinates are

int BucketCount(float extent) { return std::clamp(1 + static_cast<int>(extent / kBucketSize), 1, kMostBuckets); }

// Which bucket along one axis; clamped as float, since the conversion of a far-off float to int is undefined.
int BucketAt(float coordinate, int count) {
  return static_cast<int>(std::clamp(coordinate / kBucketSize, 0.0F, static_cast<float>(count - 1)));
}

}  // namespace

FeatureGrid::FeatureGrid(std::span<const Keypoint> keypoints) : keypoints_(keypoints) {
  if (keypoints.empty()) return;
  float right = left_ = keypoints[0].u, bottom = top_ = keypoints[0].v;
  for (const Keypoint& keypoint : keypoints) {
    left_ = std::min(left_, keypoint.u), right = std::max(right, keypoint.u);
    top_ = std::min(top_, keypoint.v), bottom = std::max(bottom, keypoint.v);
  }
  columns_ = BucketCount(right - left_);
  rows_ = BucketCount(bottom - top_);
  // Counting sort: begins are ends of the bucket before.
  starts_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  const auto bucket = [&](const Keypoint& keypoint) { return BucketIndex(Column(keypoint.u), Row(keypoint.v)); };
  for (const Keypoint& keypoint : keypoints) ++starts_[bucket(keypoint) + 1];
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  order_.resize(keypoints.size());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::uint32_t i = 0; i < keypoints.size(); ++i) order_[next[bucket(keypoints[i])]++] = i;
}

int FeatureGrid::Column(float u) const { return BucketAt(u - left_, columns_); }
int FeatureGrid::Row(float v) const { return BucketAt(v - top_, rows_); }

}  // namespace pangaea
