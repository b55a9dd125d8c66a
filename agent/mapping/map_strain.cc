#include "agent/mapping/map_strain.h"

#include <algorithm>

#include "common/geometry/reprojection.h"

namespace pangaea {
namespace {

bool Contradicts(const Keyframe& keyframe, std::uint32_t index, const Eigen::Vector3d& point_in_map,
                 const MeasurementNoiseOptions& noise) {
  const Keypoint& keypoint = keyframe.data->features.keypoints[index];
  const Eigen::Vector3d point = keyframe.camera_from_map * point_in_map;
  if (point.z() < kMinDepth) return true;
  const Eigen::Vector3d measurement = ReliableMeasurementOf(keyframe.data->camera, keypoint, noise);
  const double sigma = SigmaOf(keypoint, noise);
  const double squared = ReprojectionError(keyframe.data->camera, point, measurement).squaredNorm() / (sigma * sigma);
  return squared > (IsStereo(measurement) ? kStereoChi2 : kMonocularChi2);
}

}  // namespace

MapStrain StrainOf(const Atlas& atlas, std::span<const LandmarkId> landmarks, std::size_t samples,
                   const MeasurementNoiseOptions& noise) {
  MapStrain strain;
  const std::size_t stride = std::max<std::size_t>(1, landmarks.size() / samples);
  for (std::size_t i = 0; i < landmarks.size(); i += stride) {
    const Landmark* landmark = atlas.FindLandmark(landmarks[i]);
    if (landmark == nullptr) continue;
    strain.observations += landmark->observations.size();
    for (const Observation& observation : landmark->observations) {
      const Keyframe& keyframe = *atlas.FindKeyframe(observation.keyframe);
      strain.contradicting += Contradicts(keyframe, observation.keypoint, landmark->point_in_map, noise) ? 1 : 0;
    }
  }
  return strain;
}

}  // namespace pangaea
