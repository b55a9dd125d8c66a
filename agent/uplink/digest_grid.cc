#include "agent/uplink/digest_grid.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "agent/absorption/absorption.h"
#include "common/map/digest.h"
#include "common/map/map_edit.h"
#include "common/map/spanning_tree.h"

namespace pangaea {
namespace {

// Far above rounding, far below the grid and anything a camera sees.
constexpr double kNudge = 1e-6;
constexpr int kMostNudges = 20;

bool SameCells(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double quantum) {
  for (int i = 0; i < 3; ++i) {
    if (std::llround(a[i] / quantum) != std::llround(b[i] / quantum)) return false;
  }
  return true;
}

// Another direction for every attempt, so that no number stays on a boundary.
Eigen::Vector3d NudgeOf(int attempt) { return kNudge * attempt * Eigen::Vector3d(1.0, -0.7, 0.4); }

void ApplyToBoth(const MapEdit& for_agent, const MapEdit& for_mirror, Atlas& agent, Atlas& mirror,
                 std::vector<MapEdit>& own_edits, std::vector<MapEdit>& edits) {
  if (Apply(for_agent, agent)) own_edits.push_back(for_agent);
  if (Apply(for_mirror, mirror)) edits.push_back(for_mirror);
}

// The agent's own keyframes and landmarks that the server has placed go where the mirror has them.
void FollowServer(SessionId session, const Atlas& mirror, Atlas& own, std::vector<MapEdit>& own_edits) {
  const auto apply = [&](auto edit) {
    if (Apply(edit, own)) own_edits.emplace_back(std::move(edit));
  };
  std::map<std::uint64_t, std::vector<std::pair<KeyframeId, Rigid3d>>> poses;  // by correction
  own.ForEachKeyframe(session, [&](const Keyframe& keyframe) {
    const Keyframe* present = mirror.FindKeyframe(keyframe.id);
    if (present == nullptr || present->corrected_at == 0) return;
    if (OnSameGrid(present->camera_from_map, keyframe.camera_from_map)) return;
    poses[present->corrected_at].emplace_back(keyframe.id, present->camera_from_map);
  });
  for (const auto& [correction, moved] : poses) {
    MoveKeyframes edit = MoveKeyframesTo(own, moved);
    edit.correction = correction;
    apply(std::move(edit));
  }
  MoveLandmarks points;
  own.ForEachLandmark(session, [&](const Landmark& landmark) {
    const Landmark* present = mirror.FindLandmark(landmark.id);
    if (present == nullptr || !IsReadOnly(mirror, *present, session)) return;
    if (OnSameGrid(present->point_in_map, landmark.point_in_map)) return;
    if (auto moved = MeasureLandmark(own, landmark, present->point_in_map)) points.landmarks.push_back(*moved);
  });
  if (!points.landmarks.empty()) apply(std::move(points));
}

// Landmarks of other sessions that the session's keyframes observe here and that are no more.
void LetGo(SessionId session, const Atlas& mirror, Atlas& own, std::vector<MapEdit>& own_edits) {
  std::set<LandmarkId> gone;
  own.ForEachKeyframe(session, [&](const Keyframe& keyframe) {
    for (const LandmarkId id : keyframe.landmarks) {
      if (id.valid() && id.session != session && mirror.FindLandmark(id) == nullptr) gone.insert(id);
    }
  });
  for (const LandmarkId id : gone) {
    MapEdit edit = RemoveLandmark{id};
    if (Apply(edit, own)) own_edits.push_back(std::move(edit));
  }
}

}  // namespace

bool OnSameGrid(const Eigen::Vector3d& point_in_map, const Eigen::Vector3d& other_point_in_map) {
  return SameCells(point_in_map, other_point_in_map, kDigestLength);
}

bool OnSameGrid(const Rigid3d& camera_from_map, const Rigid3d& other_camera_from_map) {
  const Rigid3d a = camera_from_map.Inverse();
  const Rigid3d b = other_camera_from_map.Inverse();
  const Eigen::Matrix3d a_rotation = a.rotation().toRotationMatrix();
  const Eigen::Matrix3d b_rotation = b.rotation().toRotationMatrix();
  return SameCells(a.translation(), b.translation(), kDigestLength) &&
         SameCells(a_rotation.col(0), b_rotation.col(0), kDigestRotation) &&
         SameCells(a_rotation.col(1), b_rotation.col(1), kDigestRotation);
}

std::vector<MapEdit> AgreeOnDigest(SessionId session, const Atlas& agent, Atlas& mirror, std::vector<MapEdit>& edits) {
  std::vector<MapEdit> own_edits;
  Atlas own = agent;
  LetGo(session, mirror, own, own_edits);
  FollowServer(session, mirror, own, own_edits);
  agent.ForEachKeyframe(session, [&](const Keyframe& keyframe) {
    const KeyframeId id = keyframe.id;
    const auto agree = [&] {
      const Keyframe* present = mirror.FindKeyframe(id);
      return present == nullptr || IsReadOnly(*present, session) ||
             OnSameGrid(present->camera_from_map, own.FindKeyframe(id)->camera_from_map);
    };
    for (int attempt = 1; attempt <= kMostNudges && !agree(); ++attempt) {
      Vector6d twist;
      twist << NudgeOf(attempt), NudgeOf(attempt);
      const std::vector<std::pair<KeyframeId, Rigid3d>> pose = {{id, Rigid3d::Exp(twist) * keyframe.camera_from_map}};
      ApplyToBoth(MoveKeyframesTo(own, pose), MoveKeyframesTo(mirror, pose), own, mirror, own_edits, edits);
    }
  });
  agent.ForEachLandmark(session, [&](const Landmark& landmark) {
    const LandmarkId id = landmark.id;
    const auto agree = [&] {
      const Landmark* present = mirror.FindLandmark(id);
      return present != nullptr && (IsReadOnly(mirror, *present, session) ||
                                    OnSameGrid(present->point_in_map, own.FindLandmark(id)->point_in_map));
    };
    for (int attempt = 1; attempt <= kMostNudges && !agree(); ++attempt) {
      const std::vector<std::pair<LandmarkId, Eigen::Vector3d>> point = {
          {id, landmark.point_in_map + NudgeOf(attempt)}};
      const MoveLandmarks for_own = MoveLandmarksTo(own, point);
      const MoveLandmarks for_mirror = MoveLandmarksTo(mirror, point);
      if (for_own.landmarks.empty() || for_mirror.landmarks.empty()) break;
      ApplyToBoth(for_own, for_mirror, own, mirror, own_edits, edits);
    }
    if (!agree()) ApplyToBoth(RemoveLandmark{id}, RemoveLandmark{id}, own, mirror, own_edits, edits);
  });
  return own_edits;
}

}  // namespace pangaea
