#include "common/mapping/relocalization.h"

#include <algorithm>
#include <vector>

namespace pangaea {
namespace {

// The keypoints of a keyframe that show a landmark, ready for matching.
struct KeyframeView {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  std::vector<Eigen::Vector3d> points_in_map;
};

KeyframeView ViewOf(const Atlas& atlas, const Keyframe& keyframe) {
  KeyframeView view;
  for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    if (!keyframe.landmarks[i].valid()) continue;
    view.keypoints.push_back(keyframe.data->features.keypoints[i]);
    view.descriptors.push_back(keyframe.data->features.descriptors[i]);
    view.points_in_map.push_back(atlas.FindLandmark(keyframe.landmarks[i])->point_in_map);
  }
  return view;
}

std::vector<PoseObservation> Observations(const KeyframeView& view, const Features& features,
                                          std::span<const Match> matches, double sigma) {
  std::vector<PoseObservation> observations;
  observations.reserve(matches.size());
  for (const Match& match : matches) {
    const Keypoint& keypoint = features.keypoints[match.train];
    PoseObservation& observation = observations.emplace_back();
    observation.point_in_map = view.points_in_map[match.query];
    observation.measurement = Eigen::Vector3d(keypoint.u, keypoint.v, -1.0);
    observation.inverse_sigma = 1.0 / (sigma * OctaveSigma(keypoint.octave));
  }
  return observations;
}

}  // namespace

std::vector<Relocalized> Relocalize(const IdealCamera& camera, const Features& features, const Atlas& atlas,
                                    std::span<const KeyframeId> candidates, const RelocalizationOptions& options,
                                    std::uint64_t seed) {
  std::vector<Relocalized> poses;
  for (const KeyframeId id : candidates) {
    const Keyframe* keyframe = atlas.FindKeyframe(id);
    if (keyframe == nullptr) continue;
    const KeyframeView view = ViewOf(atlas, *keyframe);
    const auto matches = FilterByRotation(MatchBruteForce(view.descriptors, features.descriptors, options.matching),
                                          view.keypoints, features.keypoints);
    if (matches.size() < options.min_matches) continue;
    const auto observations = Observations(view, features, matches, options.sigma);
    const auto pose = EstimateAbsolutePose(camera, observations, options.pose, seed);
    if (pose) poses.push_back({id, pose->pose.camera_from_map, pose->pose.inliers});
  }
  std::stable_sort(poses.begin(), poses.end(),
                   [](const Relocalized& a, const Relocalized& b) { return a.inliers > b.inliers; });
  return poses;
}

}  // namespace pangaea
