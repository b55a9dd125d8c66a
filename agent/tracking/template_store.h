#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <unordered_map>
#include <vector>

#include "agent/tracking/patch_template.h"
#include "common/map/ids.h"

namespace pangaea {

// The templates of landmarks, a few views of each; owned by tracking. Bounded: the landmark that came first goes first.
class TemplateStore {
 public:
  static constexpr std::size_t kViewsPerLandmark = 3;  // frontal, and one from either side

  explicit TemplateStore(std::size_t max_landmarks) : max_landmarks_(max_landmarks) {}

  // At most kViewsPerLandmark, oldest first. Valid until the next Add.
  std::span<const PatchTemplate> Find(LandmarkId landmark) const;
  bool Has(LandmarkId landmark) const { return templates_.contains(landmark); }
  // A further view of the landmark; the second oldest gives way, the first, which defines the point, stays.
  void Add(LandmarkId landmark, const PatchTemplate& view);
  void Clear();
  std::size_t size() const { return templates_.size(); }

 private:
  std::size_t max_landmarks_;
  std::unordered_map<LandmarkId, std::vector<PatchTemplate>> templates_;
  std::deque<LandmarkId> order_;
};

}  // namespace pangaea
