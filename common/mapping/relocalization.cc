#include "common/mapping/relocalization.h"

#include <algorithm>
#include <vector>

#include "common/map/covisibility.h"
#include "common/map/id_set.h"

namespace pangaea {
namespace {

// Landmarks, each with a keypoint that shows it, ready for matching.
struct SightedLandmarks {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  std::vector<Eigen::Vector3d> points_in_map;
};

// Each landmark as the first of the keyframes that see it does.
SightedLandmarks LandmarksOf(const Atlas& atlas, std::span<const KeyframeId> keyframes) {
  SightedLandmarks known;
  LandmarkIdSet seen;
  for (const KeyframeId id : keyframes) {
    const Keyframe& keyframe = *atlas.FindKeyframe(id);
    for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
      if (!keyframe.landmarks[i].valid() || !seen.Insert(keyframe.landmarks[i])) continue;
      known.keypoints.push_back(keyframe.data->features.keypoints[i]);
      known.descriptors.push_back(keyframe.data->features.descriptors[i]);
      known.points_in_map.push_back(atlas.FindLandmark(keyframe.landmarks[i])->point_in_map);
    }
  }
  return known;
}

std::vector<PoseObservation> Observations(const SightedLandmarks& known, const Features& features,
                                          std::span<const Match> matches, double sigma) {
  std::vector<PoseObservation> observations;
  observations.reserve(matches.size());
  for (const Match& match : matches) {
    const Keypoint& keypoint = features.keypoints[match.train];
    PoseObservation& observation = observations.emplace_back();
    observation.point_in_map = known.points_in_map[match.query];
    observation.measurement = Eigen::Vector3d(keypoint.u, keypoint.v, -1.0);
    observation.inverse_sigma = 1.0 / (sigma * OctaveSigma(keypoint.octave));
  }
  return observations;
}

}  // namespace

std::vector<Relocalized> Relocalize(const IdealCamera& camera, const Features& features, const Atlas& atlas,
                                    std::span<const KeyframeId> candidates, std::size_t window,
                                    const RelocalizationOptions& options, std::uint64_t seed) {
  std::vector<Relocalized> poses;
  for (const KeyframeId id : candidates) {
    const SightedLandmarks known = LandmarksOf(atlas, GrowWindow(atlas, id, window));
    const auto matches = FilterByRotation(MatchBruteForce(known.descriptors, features.descriptors, options.matching),
                                          known.keypoints, features.keypoints);
    if (matches.size() < options.min_matches) continue;
    const auto observations = Observations(known, features, matches, options.sigma);
    const auto pose = EstimateAbsolutePose(camera, observations, options.pose, seed);
    if (pose) poses.push_back({id, pose->pose.camera_from_map, pose->pose.inliers});
  }
  std::stable_sort(poses.begin(), poses.end(),
                   [](const Relocalized& a, const Relocalized& b) { return a.inliers > b.inliers; });
  return poses;
}

}  // namespace pangaea
