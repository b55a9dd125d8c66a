#include "common/mapping/observer_spread.h"

#include <algorithm>

#include "common/base/check.h"

namespace pangaea {

double PredictionVariance(const ObserverSpread& observers, const Eigen::Vector3d& camera_in_map) {
  const double distance = (camera_in_map - observers.center).squaredNorm();
  const double of_the_mean = 1.0 / observers.observations;
  return 1.0 + of_the_mean + distance / std::max(observers.squares, 1e-12);
}

ObserverSpread ObserverCenters::SpreadOf(const Landmark& landmark) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double squares = 0.0;
  double stereo = 0.0;
  for (const Observation& observation : landmark.observations) {
    const Observer& observer = Find(observation.keyframe);
    sum += observer.center;
    squares += observer.center.squaredNorm();
    if (observer.stereo_squares == 0.0) continue;
    const Keypoint& keypoint = observer.keyframe->data->features.keypoints[observation.keypoint];
    if (keypoint.has_depth()) stereo += observer.stereo_squares;
  }
  const auto count = static_cast<double>(landmark.observations.size());
  return {static_cast<int>(landmark.observations.size()), sum / count,
          std::max(squares - sum.squaredNorm() / count, 0.0) + stereo};
}

const ObserverCenters::Observer& ObserverCenters::Find(KeyframeId id) {
  Observer& observer = observers_[id];
  if (observer.keyframe != nullptr) return observer;
  observer.keyframe = atlas_.FindKeyframe(id);
  PANGAEA_CHECK(observer.keyframe != nullptr);
  observer.center = observer.keyframe->camera_from_map.Inverse().translation();
  const double baseline = observer.keyframe->data->camera.baseline;
  observer.stereo_squares = 0.5 * baseline * baseline;
  return observer;
}

}  // namespace pangaea
