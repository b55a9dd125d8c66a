#include "agent/mapping/neighbourhood.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "common/mapping/view_overlap.h"
#include "common/mapping/view_prediction.h"

namespace pangaea {
namespace {

// Keyframes that look at the same place from nearly the same direction, best overlap first.
std::vector<KeyframeId> LookingAtTheSame(const Atlas& atlas, const Keyframe& center, const std::set<KeyframeId>& known,
                                         const NeighbourhoodOptions& options) {
  const Viewpoint viewpoint(center);
  const Eigen::Vector3d axis = center.camera_from_map.rotation().conjugate() * Eigen::Vector3d::UnitZ();
  const double min_cosine = std::cos(options.max_axis_angle * std::numbers::pi / 180.0);
  std::vector<std::pair<double, KeyframeId>> ranked;
  atlas.ForEachKeyframe([&](const Keyframe& other) {
    if (other.map != center.map || known.contains(other.id)) return;
    const Eigen::Vector3d other_axis = other.camera_from_map.rotation().conjugate() * Eigen::Vector3d::UnitZ();
    if (axis.dot(other_axis) < min_cosine) return;
    const double share = VisibleShare(atlas, other, viewpoint, options.overlap_samples);
    if (share >= options.min_overlap) ranked.emplace_back(-share, other.id);
  });
  const std::size_t count = std::min(options.overlapping, ranked.size());
  std::partial_sort(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count), ranked.end());
  std::vector<KeyframeId> result;
  for (std::size_t i = 0; i < count; ++i) result.push_back(ranked[i].second);
  return result;
}

}  // namespace

std::vector<KeyframeId> BestCovisible(const Keyframe& keyframe, std::size_t count) {
  std::vector<Covisibility> ranked = keyframe.covisible;
  const std::size_t kept = std::min(count, ranked.size());
  std::partial_sort(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(kept), ranked.end(),
                    [](const Covisibility& a, const Covisibility& b) {
                      return a.weight != b.weight ? a.weight > b.weight : a.keyframe > b.keyframe;
                    });
  std::vector<KeyframeId> best;
  for (std::size_t i = 0; i < kept; ++i) best.push_back(ranked[i].keyframe);
  return best;
}

std::vector<KeyframeId> Neighbourhood(const Atlas& atlas, const Keyframe& center, const NeighbourhoodOptions& options) {
  std::vector<KeyframeId> result;
  std::set<KeyframeId> known{center.id};
  const auto add = [&](KeyframeId id) {
    if (known.insert(id).second) result.push_back(id);
  };
  for (const KeyframeId id : BestCovisible(center, options.first)) add(id);
  if (center.parent.valid()) add(center.parent);
  const std::vector<KeyframeId> first = result;
  for (const KeyframeId id : first) {
    for (const KeyframeId second : BestCovisible(*atlas.FindKeyframe(id), options.second_of_each)) add(second);
  }
  for (const KeyframeId id : LookingAtTheSame(atlas, center, known, options)) add(id);
  return result;
}

}  // namespace pangaea
