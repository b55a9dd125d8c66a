#include "server/fusion/map_fusion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/base/range_check.h"
#include "common/map/covisibility.h"
#include "common/map/spanning_tree.h"
#include "common/mapping/view_overlap.h"
#include "server/fusion/duplicate_fusion.h"
#include "server/fusion/welding_draft.h"

namespace pangaea {
namespace {

Eigen::Vector3d AxisInMap(const Keyframe& keyframe) {
  return keyframe.camera_from_map.rotation().conjugate() * Eigen::Vector3d::UnitZ();
}

// How much of what `other` sees the keyframe shares.
double SharedPart(const Keyframe& keyframe, const Keyframe& other) {
  const auto edge = std::lower_bound(keyframe.covisible.begin(), keyframe.covisible.end(), other.id,
                                     [](const Covisibility& c, KeyframeId id) { return c.keyframe < id; });
  if (edge == keyframe.covisible.end() || edge->keyframe != other.id) return 0.0;
  const auto seen =
      std::count_if(other.landmarks.begin(), other.landmarks.end(), [](LandmarkId id) { return id.valid(); });
  return seen == 0 ? 0.0 : static_cast<double>(edge->weight) / static_cast<double>(seen);
}

// Those of the map that see most of what the keyframe has in view but does not know.
std::vector<KeyframeId> Strangers(const Atlas& atlas, const Keyframe& keyframe, const std::vector<KeyframeId>& map,
                                  const MapFusionOptions& options) {
  const Viewpoint viewpoint(keyframe);
  const Eigen::Vector3d axis = AxisInMap(keyframe);
  const double min_cosine = std::cos(options.max_axis_angle * std::numbers::pi / 180.0);
  std::vector<std::pair<double, KeyframeId>> ranked;
  for (const KeyframeId id : map) {
    const Keyframe& other = *atlas.FindKeyframe(id);
    if (id == keyframe.id || AxisInMap(other).dot(axis) < min_cosine) continue;
    const double unshared = VisibleShare(atlas, other, viewpoint, options.samples) - SharedPart(keyframe, other);
    if (unshared >= options.min_unshared) ranked.emplace_back(-unshared, id);
  }
  const std::size_t count = std::min(options.others, ranked.size());
  std::partial_sort(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count), ranked.end());
  std::vector<KeyframeId> strangers;
  for (std::size_t i = 0; i < count; ++i) strangers.push_back(ranked[i].second);
  return strangers;
}

}  // namespace

Status MapFusionOptions::Check() const {
  RangeCheck check("map fusion");
  check.In("others", others, 1, 1000)
      .In("min_unshared", min_unshared, 0, 1)
      .In("samples", samples, 1, 10000)
      .In("max_axis_angle", max_axis_angle, 0, 180);
  return check.status();
}

MapFusion FuseDuplicates(const Atlas& snapshot, MapId map, const std::vector<KeyframeId>& keyframes,
                         const MapFusionOptions& options, std::stop_token stop) {
  WeldingDraft draft(snapshot);
  DuplicateFusion fusion({}, options.search, draft);
  const std::vector<KeyframeId> all = ParentsFirst(snapshot, map);
  for (const KeyframeId id : keyframes) {
    if (stop.stop_requested()) break;
    const Keyframe* keyframe = draft.welded().FindKeyframe(id);
    if (keyframe == nullptr || keyframe->map != map) continue;
    fusion.SearchIn(id, LandmarksSeenBy(draft.welded(), Strangers(draft.welded(), *keyframe, all, options)));
  }
  MapFusion result{.edits = draft.edits(), .correction = draft.Moves(map)};
  for (const MapEdit& edit : result.edits) {
    result.fused += std::holds_alternative<FuseLandmarks>(edit) ? 1 : 0;
    result.added += std::holds_alternative<AddObservation>(edit) ? 1 : 0;
  }
  return result;
}

}  // namespace pangaea
