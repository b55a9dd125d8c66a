#include "agent/mapping/keyframe_insertion.h"

#include <map>
#include <optional>

namespace pangaea {
namespace {

// The landmark of each keypoint as it lives now in `map`; one landmark at most once, at its first keypoint.
std::map<LandmarkId, std::uint32_t> LivingLandmarks(const Atlas& atlas, const KeyframeCandidate& candidate) {
  std::map<LandmarkId, std::uint32_t> living;
  for (std::uint32_t keypoint = 0; keypoint < candidate.landmarks.size(); ++keypoint) {
    if (!candidate.landmarks[keypoint].valid()) continue;
    const LandmarkId id = atlas.Resolve(candidate.landmarks[keypoint]);
    const Landmark* landmark = atlas.FindLandmark(id);
    if (landmark == nullptr || atlas.FindKeyframe(landmark->reference)->map != candidate.map) continue;
    living.try_emplace(id, keypoint);
  }
  return living;
}

// The keyframe that observes most of the landmarks, the newer one of equals; `otherwise` where there is none.
KeyframeId ChooseParent(const Atlas& atlas, const std::map<LandmarkId, std::uint32_t>& landmarks,
                        KeyframeId otherwise) {
  std::map<KeyframeId, int> shared;
  for (const auto& [id, keypoint] : landmarks) {
    for (const Observation& observation : atlas.FindLandmark(id)->observations) ++shared[observation.keyframe];
  }
  KeyframeId best = otherwise;
  int most = 0;
  for (const auto& [keyframe, count] : shared) {
    if (count < most) continue;
    best = keyframe;
    most = count;
  }
  return best;
}

std::optional<AddKeyframe> MakeRoot(const Atlas& atlas, const KeyframeCandidate& candidate) {
  if (atlas.FindMap(candidate.map) != nullptr) return std::nullopt;
  return AddKeyframe{.id = candidate.id,
                     .map = candidate.map,
                     .parent = {},
                     .camera_from_parent = candidate.camera_from_reference,
                     .data = candidate.data};
}

std::optional<AddKeyframe> MakeChild(const Atlas& atlas, const KeyframeCandidate& candidate,
                                     const std::map<LandmarkId, std::uint32_t>& landmarks) {
  const MapInfo* map = atlas.FindMap(candidate.map);
  const Keyframe* reference = atlas.FindKeyframe(candidate.reference);
  if (map == nullptr || map->closed || reference == nullptr || reference->map != candidate.map) return std::nullopt;
  const Rigid3d camera_from_map = candidate.camera_from_reference * reference->camera_from_map;
  const KeyframeId parent = ChooseParent(atlas, landmarks, reference->id);
  return AddKeyframe{.id = candidate.id,
                     .map = candidate.map,
                     .parent = parent,
                     .camera_from_parent = camera_from_map * atlas.FindKeyframe(parent)->camera_from_map.Inverse(),
                     .data = candidate.data};
}

}  // namespace

std::vector<MapEdit> InsertKeyframe(const Atlas& atlas, const KeyframeCandidate& candidate) {
  if (atlas.FindKeyframe(candidate.id) != nullptr) return {};
  const std::map<LandmarkId, std::uint32_t> landmarks = LivingLandmarks(atlas, candidate);
  std::optional<AddKeyframe> keyframe =
      candidate.reference.valid() ? MakeChild(atlas, candidate, landmarks) : MakeRoot(atlas, candidate);
  if (!keyframe) return {};
  std::vector<MapEdit> edits;
  edits.reserve(1 + landmarks.size());
  edits.push_back(std::move(*keyframe));
  for (const auto& [landmark, keypoint] : landmarks) {
    edits.push_back(AddObservation{.landmark = landmark, .keyframe = candidate.id, .keypoint = keypoint});
  }
  return edits;
}

}  // namespace pangaea
