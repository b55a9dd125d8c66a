#include "common/map/trajectory.h"

#include <algorithm>
#include <map>

#include "common/map/frame_correction.h"

namespace pangaea {
namespace {

// By the keyframe that holds the frames, ascending by when they end.
using Corrections = std::map<KeyframeId, std::vector<FrameCorrection>>;

Corrections CorrectionsOf(const Atlas& atlas, SessionId session) {
  Corrections corrections;
  atlas.ForEachKeyframe(session, [&](const Keyframe& keyframe) {
    if (auto correction = FrameCorrection::Of(keyframe, atlas)) {
      corrections[correction->holder()].push_back(std::move(*correction));
    }
  });
  for (auto& [holder, of_holder] : corrections) std::ranges::sort(of_holder, {}, &FrameCorrection::until_ns);
  return corrections;
}

Rigid3d HolderFromFrame(const FramePose& frame, const std::vector<FrameCorrection>& corrections) {
  const auto next = std::ranges::lower_bound(corrections, frame.stamp_ns, {}, &FrameCorrection::until_ns);
  return next != corrections.end() && next->Corrects(frame) ? next->HolderFromFrame(frame) : frame.reference_from_frame;
}

// The poses that one keyframe holds of a session's frames.
void AppendFrames(const Keyframe& keyframe, SessionId session, const Corrections& corrections,
                  std::vector<TrajectoryPose>& trajectory) {
  if (!keyframe.frames) return;
  const Rigid3d map_from_reference = keyframe.camera_from_map.Inverse();
  const auto found = corrections.find(keyframe.id);
  static const std::vector<FrameCorrection> kNone;
  const std::vector<FrameCorrection>& of_holder = found == corrections.end() ? kNone : found->second;
  for (const FramePose& frame : *keyframe.frames) {
    if (frame.session != session) continue;
    trajectory.push_back({frame.stamp_ns, keyframe.map, map_from_reference * HolderFromFrame(frame, of_holder)});
  }
}

}  // namespace

std::vector<TrajectoryPose> SessionTrajectory(const Atlas& atlas, SessionId session, std::optional<MapId> map) {
  std::vector<TrajectoryPose> trajectory;
  const Corrections corrections = CorrectionsOf(atlas, session);
  const auto counts = [&](const Keyframe& keyframe) { return !map || keyframe.map == *map; };
  // Keyframes come first: they are where they are, also where the frame that one was made of later is known, too, and
  // does not share its correction (another map's, or no arrival).
  atlas.ForEachKeyframe(session, [&](const Keyframe& keyframe) {
    if (!counts(keyframe)) return;
    trajectory.push_back({keyframe.data->stamp_ns, keyframe.map, keyframe.camera_from_map.Inverse()});
  });
  // Keyframes of the others as well: culling may have handed them frames of this session.
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    if (counts(keyframe)) AppendFrames(keyframe, session, corrections, trajectory);
  });
  const auto by_stamp = [](const TrajectoryPose& a, const TrajectoryPose& b) { return a.stamp_ns < b.stamp_ns; };
  const auto same_stamp = [](const TrajectoryPose& a, const TrajectoryPose& b) { return a.stamp_ns == b.stamp_ns; };
  std::stable_sort(trajectory.begin(), trajectory.end(), by_stamp);
  trajectory.erase(std::unique(trajectory.begin(), trajectory.end(), same_stamp), trajectory.end());
  return trajectory;
}

}  // namespace pangaea
