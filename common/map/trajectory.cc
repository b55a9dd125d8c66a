#include "common/map/trajectory.h"

#include <algorithm>

namespace pangaea {
namespace {

// The poses that one keyframe holds of a session: its own, if it is the session's, and its frames'.
void AppendPoses(const Keyframe& keyframe, SessionId session, std::vector<TrajectoryPose>& trajectory) {
  const Rigid3d map_from_reference = keyframe.camera_from_map.Inverse();
  if (keyframe.id.session == session) {
    trajectory.push_back({keyframe.data->stamp_ns, keyframe.map, map_from_reference});
  }
  if (!keyframe.frames) return;
  for (const FramePose& frame : *keyframe.frames) {
    if (frame.session != session) continue;
    trajectory.push_back({frame.stamp_ns, keyframe.map, map_from_reference * frame.reference_from_frame});
  }
}

}  // namespace

std::vector<TrajectoryPose> SessionTrajectory(const Atlas& atlas, SessionId session, std::optional<MapId> map) {
  std::vector<TrajectoryPose> trajectory;
  // Keyframes of the others as well: culling may have handed them frames of this session.
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    if (!map || keyframe.map == *map) AppendPoses(keyframe, session, trajectory);
  });
  const auto by_stamp = [](const TrajectoryPose& a, const TrajectoryPose& b) { return a.stamp_ns < b.stamp_ns; };
  const auto same_stamp = [](const TrajectoryPose& a, const TrajectoryPose& b) { return a.stamp_ns == b.stamp_ns; };
  std::stable_sort(trajectory.begin(), trajectory.end(), by_stamp);
  trajectory.erase(std::unique(trajectory.begin(), trajectory.end(), same_stamp), trajectory.end());
  return trajectory;
}

}  // namespace pangaea
