#include "agent/tracking/resolved_pose.h"

namespace pangaea {

std::optional<Rigid3d> PoseOf(const Atlas& atlas, KeyframeId id) {
  const auto resolved = atlas.ResolvePose(id);
  if (!resolved) return std::nullopt;
  return resolved->keyframe_from_asked.Inverse() * resolved->keyframe->camera_from_map;
}

bool IsInMap(const Atlas& atlas, KeyframeId id, MapId map) {
  const Keyframe* keyframe = atlas.FindKeyframe(atlas.Resolve(id));
  return keyframe != nullptr && keyframe->map == map;
}

}  // namespace pangaea
