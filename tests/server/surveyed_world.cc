#include "tests/server/surveyed_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace pangaea::testing {
namespace {

// What the camera of the session saw of it.
std::shared_ptr<const KeyframeData> AsSeenBy(const KeyframeData& seen, const SurveyOptions& options,
                                             std::int64_t stamp_ns) {
  auto data = std::make_shared<KeyframeData>(seen);
  data->stamp_ns = stamp_ns;
  if (options.stereo) return data;
  data->camera.baseline = 0.0;
  for (Keypoint& keypoint : data->features.keypoints) keypoint.u_right = -1.0F;
  return data;
}

}  // namespace

SurveyedWorld::SurveyedWorld(std::uint64_t seed, int corners)
    : room_(SyntheticWorldOptions{.seed = seed, .points = corners}), random_(seed + 1000) {}

void SurveyedWorld::Do(const MapEdit& edit) {
  const Status status = Apply(edit, atlas);
  EXPECT_TRUE(status.has_value()) << KindName(edit) << ": " << (status ? "" : status.error().message);
}

Similarity3d SurveyedWorld::Session::DriftedMapFromWorld() const {
  const double steps = static_cast<double>(keyframes.size());
  const Rigid3d crept = Rigid3d::Exp(steps * options.drift_per_keyframe);
  return options.map_from_world *
         Similarity3d(std::exp(steps * options.scale_drift_per_keyframe), crept.rotation(), crept.translation());
}

Rigid3d SurveyedWorld::PoseInMap(KeyframeId id, const Session& session) {
  Vector6d noise;
  for (int i = 0; i < 6; ++i) noise[i] = Normal() * session.options.pose_noise * (i < 3 ? 1.0 : 0.5);
  return session.DriftedMapFromWorld().TransformCamera(Rigid3d::Exp(noise) * room_.true_camera_from_world(id));
}

MapId SurveyedWorld::Fly(SessionId session, const std::vector<Rigid3d>& camera_from_world,
                         const SurveyOptions& options) {
  const MapId map{session, 1};
  Session& flying = sessions_[session];
  flying.options = options;
  room_.BeginMap(map);
  for (const Rigid3d& pose : camera_from_world) Map(room_.NextKeyframe(pose, Atlas()), flying, map);
  return map;
}

void SurveyedWorld::Map(const KeyframeCandidate& view, Session& session, MapId map) {
  const SurveyOptions& options = session.options;
  const std::int64_t stamp = options.stamp_ns + static_cast<std::int64_t>(session.keyframes.size()) * 1'000'000'000;
  const KeyframeId parent = session.keyframes.empty() ? KeyframeId{} : session.keyframes.back();
  const Rigid3d camera_from_map = PoseInMap(view.id, session);
  const Rigid3d parent_from_map = parent.valid() ? atlas.FindKeyframe(parent)->camera_from_map : Rigid3d();
  Do(AddKeyframe{.id = view.id,
                 .map = map,
                 .parent = parent,
                 .camera_from_parent = camera_from_map * parent_from_map.Inverse(),
                 .data = AsSeenBy(*view.data, options, stamp)});
  session.keyframes.push_back(view.id);
  const std::vector<int>& corners = room_.points_of(view.id);
  for (std::uint32_t k = 0; k < corners.size(); ++k) MapCorner(*atlas.FindKeyframe(view.id), k, corners[k], session);
}

void SurveyedWorld::MapCorner(const Keyframe& keyframe, std::uint32_t keypoint, int corner, Session& session) {
  const std::size_t now = session.keyframes.size();
  const auto known = session.corners.find(corner);
  if (known != session.corners.end() && known->second.last_seen + session.options.remembered >= now) {
    known->second.last_seen = now;
    if (known->second.landmark.valid()) Do(AddObservation{known->second.landmark, keyframe.id, keypoint});
    return;
  }
  KnownCorner& entry = session.corners[corner];
  entry = {.landmark = {}, .last_seen = now};
  if (std::uniform_real_distribution<double>()(random_) > session.options.mapped) return;
  const Eigen::Vector3d noise{Normal(), Normal(), Normal()};  // braces draw in order
  const Eigen::Vector3d point = CornerPosition(corner) + session.options.point_noise * noise;
  entry.landmark = {keyframe.id.session, ++session.landmarks};
  const Eigen::Vector3d point_in_map = session.DriftedMapFromWorld() * point;
  Do(AddLandmark{entry.landmark, keyframe.id, keypoint, keyframe.camera_from_map * point_in_map});
}

PlaceMatch SurveyedWorld::TrueMatch(KeyframeId query, KeyframeId candidate) const {
  const SurveyOptions& of_query = sessions_.at(query.session).options;
  const SurveyOptions& of_candidate = sessions_.at(candidate.session).options;
  const Rigid3d motion = TrueCameraFromWorld(candidate) * TrueCameraFromWorld(query).Inverse();
  const double query_scale = of_query.map_from_world.scale();
  const double candidate_scale = of_candidate.map_from_world.scale();
  PlaceMatch match;
  match.query = query;
  match.candidate = candidate;
  match.candidate_from_query =
      Similarity3d(candidate_scale / query_scale, motion.rotation(), candidate_scale * motion.translation());
  match.metric = of_query.stereo && of_candidate.stereo;
  std::map<int, LandmarkId> seen;
  for (const LandmarkId id : atlas.FindKeyframe(candidate)->landmarks) {
    if (id.valid()) seen[CornerOf(atlas.FindLandmark(id)->observations.front())] = id;
  }
  for (const LandmarkId id : atlas.FindKeyframe(query)->landmarks) {
    if (!id.valid()) continue;
    const auto same = seen.find(CornerOf(atlas.FindLandmark(id)->observations.front()));
    if (same != seen.end()) match.landmarks.emplace_back(id, same->second);
  }
  match.evidence.matches = match.evidence.inliers = match.landmarks.size();
  return match;
}

int SurveyedWorld::CornerOf(const Observation& observation) const {
  return room_.points_of(observation.keyframe)[observation.keypoint];
}

std::vector<Rigid3d> CirclePoses(int first, int last, int n) {
  std::vector<Rigid3d> poses;
  for (int k = first; k <= last; ++k) poses.push_back(CirclePose(k, n));
  return poses;
}

}  // namespace pangaea::testing
