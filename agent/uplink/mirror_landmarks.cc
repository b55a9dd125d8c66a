// How MirrorUpdate makes landmarks and their observations follow.
#include <algorithm>

#include "agent/uplink/mirror_update.h"
#include "common/map/edits/point_form.h"
#include "common/map/forgetting.h"

namespace pangaea {
namespace {

const Observation* ObservationAt(const Landmark& landmark, KeyframeId keyframe) {
  const auto found = std::find_if(landmark.observations.begin(), landmark.observations.end(),
                                  [&](const Observation& o) { return o.keyframe == keyframe; });
  return found == landmark.observations.end() ? nullptr : &*found;
}

bool Holds(const Landmark& landmark, const Observation& observation) {
  return std::find(landmark.observations.begin(), landmark.observations.end(), observation) !=
         landmark.observations.end();
}

}  // namespace

void MirrorUpdate::MatchLandmarks(std::set<LandmarkId>& landmarks) {
  std::set<LandmarkId> waiting;
  const std::set<LandmarkId> first = landmarks;
  // Fusions first: their absorber would take the observations one by one, and the absorbed would leave no trace.
  for (const LandmarkId id : first) {
    if (agent_.FindLandmark(id) != nullptr) continue;
    landmarks.erase(id);
    if (!MatchVanished(id, landmarks)) waiting.insert(id);
  }
  while (!landmarks.empty()) {
    const LandmarkId id = *landmarks.begin();
    landmarks.erase(landmarks.begin());
    const bool done = agent_.FindLandmark(id) != nullptr ? MatchLandmark(id, landmarks) : MatchVanished(id, landmarks);
    if (!done) waiting.insert(id);
  }
  landmarks = std::move(waiting);
}

// Removes the landmark, or fuses it into what absorbed it. False while that is not sent.
bool MirrorUpdate::MatchVanished(LandmarkId id, std::set<LandmarkId>& landmarks) {
  if (mirror_.FindLandmark(id) == nullptr) return true;
  // Forgotten and not gone, or not for this agent to end: no more than what its keyframes see of it.
  if (!agent_.Knows(id) || !IsOwn(id)) {
    RemoveWrongObservations(Landmark{id, {}, {}, {}});
    return true;
  }
  const LandmarkId kept = agent_.Resolve(id);
  // Another session's landmark that the server is not known to have: it will not get it from here.
  const bool lost = kept.valid() && !IsOwn(kept) && mirror_.FindLandmark(kept) == nullptr;
  if (!kept.valid() || lost) {
    Emit(RemoveLandmark{id});
    return true;
  }
  if (mirror_.FindLandmark(kept) == nullptr) {
    const Landmark& wanted = *agent_.FindLandmark(kept);
    if (!Shows(wanted.reference)) return false;
    AddLandmarkItself(wanted, landmarks);
  }
  landmarks.insert(kept);
  // Freeing the keypoint for the absorber may have taken the last observation already.
  if (mirror_.FindLandmark(id) == nullptr) return true;
  Emit(mirror_.FindLandmark(kept) != nullptr ? MapEdit(FuseLandmarks{kept, id}) : MapEdit(RemoveLandmark{id}));
  return true;
}

// What a single keyframe shows is mostly gone a few keyframes later. Of a map's first keyframe it is all there is.
bool MirrorUpdate::IsOnTrial(const Landmark& wanted) const {
  return wanted.observations.size() < min_observations_ && agent_.FindKeyframe(wanted.reference)->parent.valid();
}

// False while the reference keyframe is not sent, or the landmark not confirmed.
bool MirrorUpdate::MatchLandmark(LandmarkId id, std::set<LandmarkId>& landmarks) {
  const Landmark& wanted = *agent_.FindLandmark(id);
  if (!IsOwn(id)) return MatchGuest(wanted, landmarks);
  const bool has_reference = Shows(wanted.reference);
  if (mirror_.FindLandmark(id) != nullptr) RemoveWrongObservations(wanted);
  if (mirror_.FindLandmark(id) == nullptr) {
    if (!has_reference || IsOnTrial(wanted)) return false;
    if (!AddLandmarkItself(wanted, landmarks)) return true;
  }
  AddMissingObservations(wanted, landmarks);
  if (!has_reference) return false;
  // With guests among the observers it is not for this agent to say which of them is the reference.
  if (HasGuests(*mirror_.FindLandmark(id))) return true;
  if (ObservationAt(*mirror_.FindLandmark(id), wanted.reference) == nullptr) return true;
  // Taking the reference's observation away passes the reference on to another: until it is the wanted one. But what
  // the agent has forgotten is not to be taken away: the mirror passes that on when it forgets it, too.
  while (mirror_.FindLandmark(id)->reference != wanted.reference) {
    const Keyframe* present = agent_.FindKeyframe(mirror_.FindLandmark(id)->reference);
    if (present != nullptr && IsForgotten(*present)) break;
    Emit(RemoveObservation{id, mirror_.FindLandmark(id)->reference});
  }
  AddMissingObservations(wanted, landmarks);
  return true;
}

// Of another session's landmark: only what the session's keyframes see of it.
bool MirrorUpdate::MatchGuest(const Landmark& wanted, std::set<LandmarkId>& landmarks) {
  if (mirror_.FindLandmark(wanted.id) == nullptr) return true;
  RemoveWrongObservations(wanted);
  if (mirror_.FindLandmark(wanted.id) != nullptr) AddMissingObservations(wanted, landmarks);
  return true;
}

bool MirrorUpdate::Shows(KeyframeId id) const {
  const Keyframe* keyframe = mirror_.FindKeyframe(id);
  return keyframe != nullptr && !IsForgotten(*keyframe);
}

bool MirrorUpdate::HasGuests(const Landmark& landmark) const {
  return std::any_of(landmark.observations.begin(), landmark.observations.end(),
                     [this](const Observation& observation) { return !IsOwn(observation.keyframe); });
}

void MirrorUpdate::RemoveWrongObservations(const Landmark& wanted) {
  const std::vector<Observation> present = mirror_.FindLandmark(wanted.id)->observations;
  for (const Observation& observation : present) {
    const Keyframe* keyframe = agent_.FindKeyframe(observation.keyframe);
    const bool forgotten = keyframe != nullptr && IsForgotten(*keyframe);
    if (IsOwn(observation.keyframe) && !forgotten && !Holds(wanted, observation))
      Emit(RemoveObservation{wanted.id, observation.keyframe});
  }
}

bool MirrorUpdate::AddLandmarkItself(const Landmark& wanted, std::set<LandmarkId>& landmarks) {
  if (!IsOwn(wanted.reference)) return false;
  const std::uint32_t keypoint = ObservationAt(wanted, wanted.reference)->keypoint;
  FreeKeypoint(wanted.reference, keypoint, wanted.id, landmarks);
  const Keyframe& reference = *mirror_.FindKeyframe(wanted.reference);
  const Eigen::Vector3d point_in_reference = QuantizePoint(reference.camera_from_map * wanted.point_in_map);
  return Emit(AddLandmark{wanted.id, wanted.reference, keypoint, point_in_reference, {reference.scale}});
}

void MirrorUpdate::AddMissingObservations(const Landmark& wanted, std::set<LandmarkId>& landmarks) {
  for (const Observation& observation : wanted.observations) {
    if (!IsOwn(observation.keyframe) || !Shows(observation.keyframe)) continue;
    if (ObservationAt(*mirror_.FindLandmark(wanted.id), observation.keyframe) != nullptr) continue;
    FreeKeypoint(observation.keyframe, observation.keypoint, wanted.id, landmarks);
    Emit(AddObservation{wanted.id, observation.keyframe, observation.keypoint});
  }
}

// What observes the keypoint in the mirror does not in the agent's atlas, where `wanted` does.
void MirrorUpdate::FreeKeypoint(KeyframeId keyframe, std::uint32_t keypoint, LandmarkId wanted,
                                std::set<LandmarkId>& landmarks) {
  const LandmarkId holder = mirror_.FindKeyframe(keyframe)->landmarks[keypoint];
  if (!holder.valid() || holder == wanted) return;
  Emit(RemoveObservation{holder, keyframe});
  landmarks.insert(holder);
}

}  // namespace pangaea
