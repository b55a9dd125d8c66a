#include "common/mapping/view_prediction.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/check.h"

namespace pangaea {
namespace {

// A point nearer than this many baselines (stereo) or map units (monocular) to the image plane is not looked for.
constexpr double kMinDepthRatio = 0.1;

struct NearestObservation {
  Observation observation;
  double cosine = -1.0;  // of the angle between the two rays
  double distance = 0.0;
};

NearestObservation FindNearestObservation(const Atlas& atlas, const Landmark& landmark,
                                          const Eigen::Vector3d& direction) {
  NearestObservation best;
  for (const Observation& observation : landmark.observations) {
    const Keyframe* observer = atlas.FindKeyframe(observation.keyframe);
    PANGAEA_CHECK(observer != nullptr);
    const Rigid3d& pose = observer->camera_from_map;
    const Eigen::Vector3d ray = landmark.point_in_map + pose.rotation().conjugate() * pose.translation();
    const double distance = ray.norm();
    const double cosine = distance > 0.0 ? ray.dot(direction) / distance : -1.0;
    if (cosine > best.cosine) best = {observation, cosine, distance};
  }
  return best;
}

}  // namespace

// A patch's size in the image falls with the distance, and octave o sees it reduced by kOctaveScale^o.
int PredictOctave(int octave, double distance, double new_distance) {
  static const double kLogScale = std::log(kOctaveScale);
  const double predicted = octave + std::log(distance / new_distance) / kLogScale;
  return static_cast<int>(std::lround(std::clamp(predicted, -1.0, static_cast<double>(kOctaves))));
}

std::optional<PredictedView> PredictView(const Atlas& atlas, const Landmark& landmark, const Viewpoint& viewpoint,
                                         double max_view_angle) {
  const Eigen::Vector3d point_in_camera = viewpoint.camera_from_map * landmark.point_in_map;
  const IdealCamera& camera = viewpoint.camera;
  if (point_in_camera.z() < kMinDepthRatio * (camera.is_stereo() ? camera.baseline : 1e-3)) return std::nullopt;
  const Eigen::Vector2d pixel = camera.Project(point_in_camera);
  if (!camera.Contains(pixel)) return std::nullopt;

  const Eigen::Vector3d ray = landmark.point_in_map - viewpoint.center_in_map;
  const double distance = ray.norm();
  const NearestObservation nearest = FindNearestObservation(atlas, landmark, ray / distance);
  if (nearest.cosine < std::cos(max_view_angle * std::numbers::pi / 180.0)) return std::nullopt;

  const Keyframe& observer = *atlas.FindKeyframe(nearest.observation.keyframe);
  const int octave = observer.data->features.keypoints[nearest.observation.keypoint].octave;
  const double u_right = camera.is_stereo() ? pixel.x() - camera.focal_x * camera.baseline / point_in_camera.z() : -1.0;
  return PredictedView{.measurement = {pixel.x(), pixel.y(), u_right},
                       .depth = point_in_camera.z(),
                       .octave = PredictOctave(octave, nearest.distance, distance),
                       .nearest = nearest.observation};
}

ProjectionQuery MakeProjectionQuery(const Atlas& atlas, const PredictedView& view, double radius, int tolerance) {
  const Features& features = atlas.FindKeyframe(view.nearest.keyframe)->data->features;
  const double scaled = radius * OctaveSigma(std::clamp(view.octave, 0, kOctaves - 1));
  return {.u = static_cast<float>(view.measurement.x()),
          .v = static_cast<float>(view.measurement.y()),
          .u_right = static_cast<float>(view.measurement.z()),
          .radius = static_cast<float>(scaled),
          .min_octave = std::max(0, view.octave - tolerance),
          .max_octave = std::min(kOctaves - 1, view.octave + tolerance),
          .descriptor = features.descriptors[view.nearest.keypoint]};
}

}  // namespace pangaea
