#include "agent/uplink/uplink_planner.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "agent/uplink/digest_grid.h"

namespace pangaea {
namespace {

// What a flush leaves as it is although it differs: far above rounding, far below the digest's grid.
constexpr double kSameLength = 1e-6;  // metres
constexpr double kSamePoint = 2e-6;   // metres; edits carry points to within QuantizePoint
constexpr double kSamePointFraction = 2e-7;
constexpr double kSameAngle = 1e-6;  // radians

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace

Status UplinkPlannerOptions::Check() const {
  if (Status status = settling.Check(); !status) return status;
  const bool sound = keyframe_move_m >= 0.0 && keyframe_turn_deg >= 0.0 && landmark_move_m >= 0.0 &&
                     landmark_move_fraction >= 0.0 && landmark_move_fraction < 1.0;
  if (sound) return {};
  return Fail(ErrorCode::kInvalidArgument, "uplink: thresholds of moves must be >= 0, the fraction also < 1");
}

UplinkPlan UplinkPlanner::Plan(const Atlas& snapshot, std::span<const MapEdit> applied_since, PlanKind kind,
                               std::span<const ForgottenKeyframe> forgotten) {
  Note(snapshot, applied_since);
  if (kind == PlanKind::kFlush || std::exchange(everything_is_new_, false)) MarkEverything(snapshot);

  UplinkPlan plan;
  const std::size_t min_observations = kind == PlanKind::kFlush ? 1 : options_.min_observations;
  MirrorUpdate update(session_, snapshot, mirror_, plan.edits, min_observations);
  const MoveThresholds thresholds = Thresholds(kind);
  if (std::exchange(vergence_is_new_, false)) update.SetVergence();
  update.MoveKeyframes(std::exchange(moved_keyframes_, {}), thresholds);
  std::vector<KeyframeId> due = Settled(snapshot, kind);
  const std::vector<KeyframeId> early = UnsentObservers(snapshot, forgotten);
  due.insert(due.end(), early.begin(), early.end());
  const std::vector<KeyframeId> added = update.AddKeyframes(due);
  for (const KeyframeId id : added) unsent_.erase(id);
  MarkLandmarksOf(snapshot, added);
  keyframes_with_frames_.insert(added.begin(), added.end());
  const std::vector<LandmarkId> bereft = update.RemoveKeyframes(std::exchange(culled_, {}));
  landmarks_.insert(bereft.begin(), bereft.end());
  update.MatchLandmarks(landmarks_);
  update.MoveLandmarks(std::exchange(moved_landmarks_, {}), thresholds);
  update.AddFrames(std::exchange(keyframes_with_frames_, {}), thresholds);
  update.AddLoopEdges();
  Forget(mirror_, forgotten);
  if (kind == PlanKind::kFlush) plan.own_edits = AgreeOnDigest(session_, snapshot, mirror_, plan.edits);
  return plan;
}

std::vector<MapEdit> UplinkPlanner::PlanClosing(const Atlas& snapshot) {
  std::vector<MapEdit> edits;
  MirrorUpdate(session_, snapshot, mirror_, edits).CloseMaps(unsent_);
  return edits;
}

std::vector<MapEdit> UplinkPlanner::PlanFarewell() {
  std::vector<MapEdit> edits;
  for (const auto& [map, survivor] : mirror_.merged_maps()) {
    if (map.session == session_ && farewells_.insert(map).second) edits.push_back(CloseMap{map});
  }
  return edits;
}

void UplinkPlanner::Note(const Atlas& snapshot, std::span<const MapEdit> applied_since) {
  for (const MapEdit& edit : applied_since) Mark(snapshot, edit);
}

void UplinkPlanner::AdoptMirror(Atlas mirror) {
  mirror_ = std::move(mirror);
  everything_is_new_ = true;
}

void UplinkPlanner::Mark(const Atlas& snapshot, const MapEdit& edit) {
  const auto mark_frames = [&](KeyframeId id) { keyframes_with_frames_.insert(snapshot.Resolve(id)); };
  std::visit(Overloaded{
                 [&](const AddKeyframe& e) {
                   if (!IsOwn(e.id)) return;
                   // One that was forgotten and came back is there.
                   if (mirror_.FindKeyframe(e.id) == nullptr) unsent_.insert(e.id);
                   newest_stamp_ns_ = std::max(newest_stamp_ns_, e.data->stamp_ns);
                 },
                 [&](const AddFramePoses& e) {
                   for (const TrackedFrame& frame : e.frames) mark_frames(frame.reference);
                   if (e.frames.empty()) return;
                   newest_stamp_ns_ = std::max(newest_stamp_ns_, e.frames.back().pose.stamp_ns);
                 },
                 [&](const AddLandmark& e) { landmarks_.insert(e.id); },
                 [&](const AddObservation& e) { landmarks_.insert(snapshot.Resolve(e.landmark)); },
                 [&](const RemoveObservation& e) { landmarks_.insert(e.landmark); },
                 [&](const MoveKeyframes& e) {
                   for (const MovedKeyframe& moved : e.keyframes) moved_keyframes_.insert(moved.id);
                 },
                 [&](const MoveLandmarks& e) {
                   for (const MovedLandmark& moved : e.landmarks) moved_landmarks_.insert(moved.id);
                 },
                 [&](const FuseLandmarks& e) {
                   landmarks_.insert(e.absorbed);
                   landmarks_.insert(snapshot.Resolve(e.kept));
                 },
                 [&](const RemoveKeyframe& e) {
                   if (unsent_.erase(e.id) == 0) culled_.insert(e.id);
                   mark_frames(e.id);
                 },
                 [&](const RemoveLandmark& e) { landmarks_.insert(e.id); },
                 [&](const AddLoopEdge&) {},  // compared every time: there are few
                 [&](const MergeMaps&) {},
                 [&](const CloseMap&) {},  // compared every time
                 [&](const SetVergence& e) { vergence_is_new_ = vergence_is_new_ || e.session == session_; },
             },
             edit);
}

void UplinkPlanner::MarkEverything(const Atlas& snapshot) {
  vergence_is_new_ = true;
  snapshot.ForEachKeyframe([&](const Keyframe& keyframe) {
    if (!IsOwn(keyframe.id)) return;
    if (mirror_.FindKeyframe(keyframe.id) == nullptr) unsent_.insert(keyframe.id);
    moved_keyframes_.insert(keyframe.id);
    keyframes_with_frames_.insert(keyframe.id);
  });
  snapshot.ForEachLandmark([&](const Landmark& landmark) {
    landmarks_.insert(landmark.id);
    moved_landmarks_.insert(landmark.id);
  });
  mirror_.ForEachKeyframe([&](const Keyframe& keyframe) { culled_.insert(keyframe.id); });
  mirror_.ForEachLandmark([&](const Landmark& landmark) { landmarks_.insert(landmark.id); });
}

void UplinkPlanner::MarkLandmarksOf(const Atlas& snapshot, std::span<const KeyframeId> keyframes) {
  for (const KeyframeId id : keyframes) {
    for (const LandmarkId landmark : snapshot.FindKeyframe(id)->landmarks) {
      if (landmark.valid()) landmarks_.insert(landmark);
    }
  }
}

// What observes landmarks of forgotten keyframes and is not sent: without it the mirror would lose these landmarks, and
// they would be sent as new ones later.
std::vector<KeyframeId> UplinkPlanner::UnsentObservers(const Atlas& snapshot,
                                                       std::span<const ForgottenKeyframe> forgotten) const {
  std::vector<KeyframeId> observers;
  for (const ForgottenKeyframe& keyframe : forgotten) {
    const Keyframe* present = mirror_.FindKeyframe(keyframe.id);
    if (present == nullptr) continue;
    for (const LandmarkId id : present->landmarks) {
      const Landmark* landmark = id.valid() ? snapshot.FindLandmark(snapshot.Resolve(id)) : nullptr;
      if (landmark == nullptr) continue;
      for (const Observation& observation : landmark->observations) {
        if (unsent_.contains(observation.keyframe)) observers.push_back(observation.keyframe);
      }
    }
  }
  return observers;
}

std::vector<KeyframeId> UplinkPlanner::Settled(const Atlas& snapshot, PlanKind kind) const {
  if (kind == PlanKind::kFlush) return {unsent_.begin(), unsent_.end()};
  return SettledKeyframes(snapshot, unsent_, newest_stamp_ns_, options_.settling);
}

MoveThresholds UplinkPlanner::Thresholds(PlanKind kind) const {
  if (kind == PlanKind::kFlush) return {kSameLength, kSameAngle, kSamePoint, kSamePointFraction, true};
  return {options_.keyframe_move_m, options_.keyframe_turn_deg * std::numbers::pi / 180.0, options_.landmark_move_m,
          options_.landmark_move_fraction, false};
}

}  // namespace pangaea
