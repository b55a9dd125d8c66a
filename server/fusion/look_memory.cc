#include "server/fusion/look_memory.h"

namespace pangaea {

LookedAtMap LookedAtMap::Of(const Atlas& atlas, MapId map) {
  LookedAtMap state;
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    if (keyframe.map == map) state.keyframes.push_back({keyframe.id, keyframe.camera_from_map});
  });
  atlas.ForEachLandmark([&](const Landmark& landmark) {
    if (atlas.MapOf(landmark) != map) return;
    state.landmarks.push_back(
        {landmark.id, landmark.point_in_map, static_cast<std::uint32_t>(landmark.observations.size())});
  });
  return state;
}

}  // namespace pangaea
