#include "agent/mapping/keyframe_insertion.h"

#include <map>
#include <optional>

#include "common/estimation/pose_refinement.h"
#include "common/map/edits/reference_scale.h"
#include "common/mapping/measurement_noise.h"

namespace pangaea {
namespace {

// With fewer the tracked pose, which saw the image itself, is the better one.
constexpr int kMinRefinementInliers = 20;

// The landmark of each keypoint as it lives now in `map`; one landmark at most once, at its first keypoint.
std::map<LandmarkId, std::uint32_t> LivingLandmarks(const Atlas& atlas, const KeyframeCandidate& candidate) {
  std::map<LandmarkId, std::uint32_t> living;
  for (std::uint32_t keypoint = 0; keypoint < candidate.landmarks.size(); ++keypoint) {
    if (!candidate.landmarks[keypoint].valid()) continue;
    const LandmarkId id = atlas.Resolve(candidate.landmarks[keypoint]);
    const Landmark* landmark = atlas.FindLandmark(id);
    if (landmark == nullptr || atlas.MapOf(*landmark) != atlas.Resolve(candidate.map)) continue;
    living.try_emplace(id, keypoint);
  }
  return living;
}

// The session's keyframe that observes most of the landmarks, the newer one of equals; `otherwise` where there is none.
KeyframeId ChooseParent(const Atlas& atlas, const std::map<LandmarkId, std::uint32_t>& landmarks, SessionId session,
                        KeyframeId otherwise) {
  std::map<KeyframeId, int> shared;
  for (const auto& [id, keypoint] : landmarks) {
    for (const Observation& observation : atlas.FindLandmark(id)->observations) {
      if (observation.keyframe.session == session) ++shared[observation.keyframe];
    }
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

// The candidate's pose on the landmarks as they are now: since it was tracked they may have moved, and it has depth of
// its own. The given pose where that does not work out.
Rigid3d RefineOnLandmarks(const Atlas& atlas, const KeyframeCandidate& candidate,
                          const std::map<LandmarkId, std::uint32_t>& landmarks, const Rigid3d& camera_from_map,
                          const MeasurementNoiseOptions& noise) {
  std::vector<PoseObservation> observations;
  for (const auto& [id, index] : landmarks) {
    const Keypoint& keypoint = candidate.data->features.keypoints[index];
    observations.push_back({.point_in_map = atlas.FindLandmark(id)->point_in_map,
                            .measurement = ReliableMeasurementOf(candidate.data->camera, keypoint, noise),
                            .inverse_sigma = 1.0 / SigmaOf(keypoint, noise)});
  }
  std::vector<std::uint8_t> inliers(observations.size());
  const PoseRefinementOptions options{.min_inliers = kMinRefinementInliers};
  const auto refined = RefinePose(candidate.data->camera, camera_from_map, observations, options, inliers);
  return refined ? refined->camera_from_map : camera_from_map;
}

std::optional<AddKeyframe> MakeChild(const Atlas& atlas, const KeyframeCandidate& candidate,
                                     const std::map<LandmarkId, std::uint32_t>& landmarks,
                                     const MeasurementNoiseOptions& noise) {
  const MapInfo* map = atlas.FindMap(atlas.Resolve(candidate.map));
  // It may have been culled since the candidate was tracked against it.
  const auto reference = atlas.ResolvePose(candidate.reference);
  if (map == nullptr || map->closed || !reference || reference->keyframe->map != map->id) return std::nullopt;
  const Rigid3d tracked =
      ScaleLengths(candidate.camera_from_reference, LengthFactor(*reference->keyframe, candidate.reference_scale)) *
      reference->keyframe_from_asked.Inverse() * reference->keyframe->camera_from_map;
  const Rigid3d camera_from_map = RefineOnLandmarks(atlas, candidate, landmarks, tracked, noise);
  const KeyframeId parent = ChooseParent(atlas, landmarks, candidate.id.session, reference->keyframe->id);
  return AddKeyframe{.id = candidate.id,
                     .map = map->id,
                     .parent = parent,
                     .camera_from_parent = camera_from_map * atlas.FindKeyframe(parent)->camera_from_map.Inverse(),
                     .data = candidate.data};
}

}  // namespace

std::vector<MapEdit> InsertKeyframe(const Atlas& atlas, const KeyframeCandidate& candidate,
                                    const MeasurementNoiseOptions& noise) {
  if (atlas.Knows(candidate.id)) return {};
  const std::map<LandmarkId, std::uint32_t> landmarks = LivingLandmarks(atlas, candidate);
  std::optional<AddKeyframe> keyframe =
      candidate.reference.valid() ? MakeChild(atlas, candidate, landmarks, noise) : MakeRoot(atlas, candidate);
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
