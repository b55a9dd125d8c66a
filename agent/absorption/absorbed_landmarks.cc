// How landmarks become what the server says: new ones, fused ones, who observes them, where they are.
#include <algorithm>
#include <map>

#include "agent/absorption/absorption_draft.h"

namespace pangaea {
namespace {

class LandmarkAbsorption {
 public:
  LandmarkAbsorption(const MapPiece& piece, AbsorptionDraft& draft) : piece_(piece), draft_(draft) {
    for (const FusedLandmark& fused : piece.fused) absorbers_[fused.absorbed] = fused.kept;
  }

  void Run() {
    for (const LandmarkId id : piece_.removed) {
      if (draft_.atlas().FindLandmark(id) != nullptr) draft_.Emit(RemoveLandmark{id});
    }
    for (const FusedLandmark& fused : piece_.fused) Fuse(fused);
    if (draft_.input().complete) DropUnlisted();
    for (const PieceLandmark& listed : piece_.landmarks) {
      if (!Insert(listed)) continue;
      DropObservations(listed);
      AddObservations(listed);
      Place(listed);
    }
    if (!points_.landmarks.empty()) draft_.Emit(std::move(points_));
  }

 private:
  const Atlas& atlas() const { return draft_.atlas(); }

  LandmarkId At(const Observation& observation) const {
    const Keyframe* keyframe = atlas().FindKeyframe(observation.keyframe);
    if (keyframe == nullptr || observation.keypoint >= keyframe->landmarks.size()) return {};
    return keyframe->landmarks[observation.keypoint];
  }

  // What keyframes of the session observe and the piece does not list, and what became one here and is two there.
  void DropUnlisted() {
    for (const PieceKeyframe& keyframe : piece_.keyframes) {
      if (!draft_.IsOwn(keyframe.id) || atlas().FindKeyframe(keyframe.id) == nullptr) continue;
      const std::vector<LandmarkId> seen = atlas().FindKeyframe(keyframe.id)->landmarks;
      for (std::uint32_t i = 0; i < seen.size(); ++i) {
        if (!seen[i].valid()) continue;
        const PieceLandmark* listed = FindIn(piece_, seen[i]);
        if (listed != nullptr && Holds(listed->observations, {keyframe.id, i})) continue;
        draft_.Emit(RemoveObservation{seen[i], keyframe.id});
      }
    }
    for (const PieceLandmark& listed : piece_.landmarks) {
      const LandmarkId survivor = atlas().Resolve(listed.id);
      if (survivor.valid() && survivor != listed.id) draft_.Emit(RemoveLandmark{survivor});
    }
  }

  void Fuse(const FusedLandmark& fused) {
    if (atlas().FindLandmark(fused.absorbed) == nullptr) return;
    const PieceLandmark* kept = FindIn(piece_, fused.kept);
    // Two agents found at once that the two are one, and each kept the other's: the one that the server kept is it.
    const bool crossed = kept != nullptr && atlas().Resolve(fused.kept) == fused.absorbed;
    if (crossed && draft_.Emit(RemoveLandmark{fused.absorbed})) {
      SeatAnywhere(*kept);
      return;
    }
    if (kept != nullptr) Insert(*kept, fused.absorbed);
    if (atlas().FindLandmark(fused.absorbed) == nullptr) return;  // its only keypoint went to the absorber
    if (!draft_.Emit(FuseLandmarks{fused.kept, fused.absorbed})) draft_.Emit(RemoveLandmark{fused.absorbed});
  }

  // True where the landmark is alive afterwards. `giving_way` is what makes room for it where it has no keypoint free.
  bool Insert(const PieceLandmark& listed, LandmarkId giving_way = {}) {
    if (atlas().FindLandmark(listed.id) != nullptr) return true;
    if (atlas().Resolve(listed.id).valid()) return false;  // fused here since
    // The server had it and it is gone here: its agent removed it since. What was forgotten leaves no trace.
    if (!draft_.input().complete && draft_.told().FindLandmark(listed.id) != nullptr && atlas().Knows(listed.id))
      return false;
    if (SeatAnywhere(listed)) return true;
    const std::vector<Observation> seats = SeatsOf(listed);
    for (const Observation& seat : seats) {
      if (!giving_way.valid() || At(seat) != giving_way) continue;
      draft_.Emit(RemoveObservation{giving_way, seat.keyframe});
      if (Seat(listed, seat)) return true;
    }
    return std::ranges::any_of(seats, [&](const Observation& seat) { return SeatInPlace(listed, seat); });
  }

  // The reference first.
  static std::vector<Observation> SeatsOf(const PieceLandmark& listed) {
    std::vector<Observation> seats = listed.observations;
    std::stable_partition(seats.begin(), seats.end(),
                          [&](const Observation& o) { return o.keyframe == listed.reference; });
    return seats;
  }

  // Where a keypoint is free.
  bool SeatAnywhere(const PieceLandmark& listed) {
    return std::ranges::any_of(SeatsOf(listed),
                               [&](const Observation& seat) { return !At(seat).valid() && Seat(listed, seat); });
  }

  // In place of what the agent saw there later than the server saw the landmark. Without it the agent would seem to
  // have removed the landmark, and the two would never agree again.
  bool SeatInPlace(const PieceLandmark& listed, const Observation& seat) {
    const LandmarkId holder = At(seat);
    if (!holder.valid() || FindIn(piece_, holder) != nullptr || WasTold(seat, holder)) return false;
    const bool made_there = WasMadeAt(seat, holder);
    draft_.Emit(RemoveObservation{holder, seat.keyframe});
    if (!Seat(listed, seat)) return false;
    if (made_there && atlas().FindLandmark(holder) != nullptr) draft_.Emit(FuseLandmarks{listed.id, holder});
    return true;
  }

  bool Seat(const PieceLandmark& listed, const Observation& seat) {
    const Keyframe* keyframe = atlas().FindKeyframe(seat.keyframe);
    if (keyframe == nullptr || seat.keypoint >= keyframe->landmarks.size()) return false;
    Eigen::Vector3d point = keyframe->camera_from_map * listed.point_in_map;
    // Its reference may be forgotten here, and another observer have it behind itself: Place puts it there.
    if (!(point.z() > 0.0)) point = Eigen::Vector3d::UnitZ();
    return draft_.Emit(AddLandmark{listed.id, seat.keyframe, seat.keypoint, point});
  }

  // Whether the server had been told that the keypoint shows the landmark, or one that it has fused into it.
  bool WasTold(const Observation& observation, LandmarkId landmark) const {
    return Shows(draft_.told(), observation, landmark);
  }

  // Whether the agent had told the server of it, and does not say so any more. What this absorption took itself is no
  // word of the agent: two that are fused and seen by one keyframe lose one of the two sightings.
  bool WasTakenBack(const Observation& observation, LandmarkId landmark) const {
    return WasTold(observation, landmark) && !Shows(draft_.before(), observation, landmark);
  }

  bool Shows(const Atlas& atlas, const Observation& observation, LandmarkId landmark) const {
    const Keyframe* keyframe = atlas.FindKeyframe(observation.keyframe);
    if (keyframe == nullptr || observation.keypoint >= keyframe->landmarks.size()) return false;
    const LandmarkId shown = keyframe->landmarks[observation.keypoint];
    if (!shown.valid()) return false;
    const auto absorber = absorbers_.find(shown);
    return shown == landmark || (absorber != absorbers_.end() && absorber->second == landmark);
  }

  static bool Holds(const std::vector<Observation>& observations, const Observation& observation) {
    return std::find(observations.begin(), observations.end(), observation) != observations.end();
  }

  void DropObservations(const PieceLandmark& listed) {
    const std::vector<Observation> present = atlas().FindLandmark(listed.id)->observations;
    for (const Observation& observation : present) {
      if (FindIn(piece_, observation.keyframe) == nullptr || Holds(listed.observations, observation)) continue;
      // What the agent found since stays.
      if (WasTold(observation, listed.id)) draft_.Emit(RemoveObservation{listed.id, observation.keyframe});
    }
  }

  void AddObservations(const PieceLandmark& listed) {
    for (const Observation& observation : listed.observations) {
      const Landmark* landmark = atlas().FindLandmark(listed.id);
      if (landmark == nullptr) return;
      const Keyframe* keyframe = atlas().FindKeyframe(observation.keyframe);
      if (keyframe == nullptr || At(observation) == listed.id) continue;
      if (WasTakenBack(observation, listed.id)) continue;
      const auto elsewhere = std::find_if(landmark->observations.begin(), landmark->observations.end(),
                                          [&](const Observation& o) { return o.keyframe == observation.keyframe; });
      if (elsewhere != landmark->observations.end()) {
        if (landmark->observations.size() == 1) continue;
        draft_.Emit(RemoveObservation{listed.id, observation.keyframe});
      }
      if (MakeRoom(observation, listed.id)) continue;
      draft_.Emit(AddObservation{listed.id, observation.keyframe, observation.keypoint});
    }
  }

  // Whether the server was told of the landmark as one made at that keypoint, and has it no more.
  bool WasMadeAt(const Observation& seat, LandmarkId landmark) const {
    const Landmark* told = draft_.told().FindLandmark(landmark);
    return told != nullptr && told->reference == seat.keyframe && FindIn(piece_, landmark) == nullptr;
  }

  // What the keypoint shows here came to the server too late, when it showed `landmark` there already. One that was
  // made at this keypoint is that landmark to the server (AddLandmark); then true: nothing is left to do.
  bool MakeRoom(const Observation& observation, LandmarkId landmark) {
    const LandmarkId holder = At(observation);
    if (!holder.valid()) return false;
    if (WasMadeAt(observation, holder) && draft_.Emit(FuseLandmarks{landmark, holder})) return true;
    draft_.Emit(RemoveObservation{holder, observation.keyframe});
    return false;
  }

  void Place(const PieceLandmark& listed) {
    const Landmark* landmark = atlas().FindLandmark(listed.id);
    if (landmark == nullptr || landmark->point_in_map == listed.point_in_map) return;
    if (auto moved = MeasureLandmark(atlas(), *landmark, listed.point_in_map)) points_.landmarks.push_back(*moved);
  }

  const MapPiece& piece_;
  AbsorptionDraft& draft_;
  std::map<LandmarkId, LandmarkId> absorbers_;
  MoveLandmarks points_;
};

}  // namespace

void AbsorbLandmarks(const MapPiece& piece, AbsorptionDraft& draft) { LandmarkAbsorption(piece, draft).Run(); }

}  // namespace pangaea
