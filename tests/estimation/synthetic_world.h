#pragma once

#include <cstddef>
#include <random>
#include <vector>

#include "common/estimation/bundle_adjustment.h"
#include "common/estimation/pose_refinement.h"

namespace pangaea::testing {

inline IdealCamera StereoCamera() {
  return {.width = 752,
          .height = 480,
          .focal_x = 435.0,
          .focal_y = 437.0,
          .center_x = 367.0,
          .center_y = 252.0,
          .baseline = 0.11};
}

inline IdealCamera MonocularCamera() {
  IdealCamera camera = StereoCamera();
  camera.baseline = 0.0;
  return camera;
}

using Random = std::mt19937_64;

inline double Uniform(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1.0p-53;
}
inline double Gauss(Random& random) {
  double sum = -6.0;  // the central limit is near enough, and the same on every platform
  for (int i = 0; i < 12; ++i) sum += Uniform(random, 0.0, 1.0);
  return sum;
}
inline Eigen::Vector3d UniformVector(Random& random, double size) {
  const double x = Uniform(random, -size, size);
  const double y = Uniform(random, -size, size);
  return {x, y, Uniform(random, -size, size)};
}
inline Rigid3d Perturbed(Random& random, const Rigid3d& pose, double translation, double rotation) {
  Vector6d twist;
  twist.head<3>() = UniformVector(random, translation);
  twist.tail<3>() = UniformVector(random, rotation);
  return Rigid3d::Exp(twist) * pose;
}

// The pixel of a point, with u_right = -1 for a camera without a right image.
inline Eigen::Vector3d Measure(const IdealCamera& camera, const Eigen::Vector3d& point_in_camera) {
  const Eigen::Vector2d pixel = camera.Project(point_in_camera);
  const double disparity = camera.focal_x * camera.baseline / point_in_camera.z();
  return {pixel.x(), pixel.y(), camera.is_stereo() ? pixel.x() - disparity : -1.0};
}

// What a camera measures where it should measure that: the right column is off as far as the left one, and by the
// disparity's own, smaller error. `sigma`: pixels.
inline Eigen::Vector3d Disturbed(Random& random, const Eigen::Vector3d& measurement, double sigma) {
  const double u = sigma * Gauss(random);
  const double v = sigma * Gauss(random);
  return measurement + Eigen::Vector3d(u, v, u - sigma / kDisparityPrecision * Gauss(random));
}

// Disturbs a measurement of a PoseObservation or BundleObservation that was exact: five out of six are several times
// better than their sigma, the sixth is as bad as it says.
template <typename Observation>
void DisturbUnevenly(Random& random, std::size_t index, Observation& observation) {
  const double sigma = (index % 6 == 5 ? 1.0 : 0.15) / observation.inverse_sigma;
  const bool stereo = IsStereo(observation.measurement);
  observation.measurement = Disturbed(random, observation.measurement, sigma);
  if (!stereo) observation.measurement.z() = -1.0;
}

// A random point in front of a camera, inside its image, in the camera frame.
inline Eigen::Vector3d VisiblePoint(Random& random, const IdealCamera& camera, double nearest, double farthest) {
  const double u = Uniform(random, 0.0, camera.width);
  const double v = Uniform(random, 0.0, camera.height);
  return camera.Unproject({u, v}) * Uniform(random, nearest, farthest);
}

struct PoseWorld {
  IdealCamera camera;
  Rigid3d camera_from_map;
  std::vector<PoseObservation> observations;
  std::vector<std::uint8_t> is_outlier;
};

struct PoseWorldOptions {
  std::size_t observations = 300;
  double noise = 0.0;  // pixels at inverse_sigma 1
  double outlier_ratio = 0.0;
  bool stereo = true;
  double nearest = 1.0;
  double farthest = 15.0;
};

inline PoseWorld MakePoseWorld(std::uint64_t seed, const PoseWorldOptions& options) {
  Random random(seed);
  PoseWorld world;
  world.camera = options.stereo ? StereoCamera() : MonocularCamera();
  world.camera_from_map = Perturbed(random, Rigid3d(), 5.0, 1.5);
  const Rigid3d map_from_camera = world.camera_from_map.Inverse();
  for (std::size_t i = 0; i < options.observations; ++i) {
    const Eigen::Vector3d point = VisiblePoint(random, world.camera, options.nearest, options.farthest);
    PoseObservation observation;
    observation.point_in_map = map_from_camera * point;
    observation.measurement = Measure(world.camera, point);
    observation.inverse_sigma = 1.0 / (1.0 + 0.2 * static_cast<double>(random() % 4));
    const double sigma = options.noise / observation.inverse_sigma;
    observation.measurement = Disturbed(random, observation.measurement, sigma);
    if (!options.stereo || i % 3 == 0) observation.measurement.z() = -1.0;
    const bool outlier = Uniform(random, 0.0, 1.0) < options.outlier_ratio;
    if (outlier) {
      observation.measurement.x() = Uniform(random, 0.0, world.camera.width);
      observation.measurement.y() = Uniform(random, 0.0, world.camera.height);
    }
    world.observations.push_back(observation);
    world.is_outlier.push_back(outlier ? 1 : 0);
  }
  return world;
}

struct BundleWorld {
  BundleProblem truth;    // its poses and points, and noisy observations
  BundleProblem problem;  // the same with disturbed free poses and points
  std::vector<std::uint8_t> is_outlier;
};

struct BundleWorldOptions {
  std::size_t free_poses = 5;
  std::size_t fixed_poses = 3;
  std::size_t points = 200;
  double noise = 1.0;  // pixels
  double outlier_ratio = 0.0;
  bool stereo = true;
  double pose_error = 0.02;   // map units and radians
  double point_error = 0.05;  // map units
  double seen_ratio = 1.0;    // of the views that are geometrically possible
  std::size_t min_views = 4;  // points with fewer are left out
};

// Cameras on an arc that look at a cloud of points; the first poses are the free ones.
inline BundleWorld MakeBundleWorld(std::uint64_t seed, const BundleWorldOptions& options) {
  Random random(seed);
  BundleWorld world;
  BundleProblem& truth = world.truth;
  truth.cameras = {options.stereo ? StereoCamera() : MonocularCamera()};
  const std::size_t poses = options.free_poses + options.fixed_poses;
  for (std::size_t i = 0; i < poses; ++i) {
    const double along = 4.0 * static_cast<double>(i) / static_cast<double>(poses);
    const Rigid3d map_from_camera(ExpSo3({0.0, -0.1 * along, 0.0}), {along, 0.2 * Uniform(random, -1.0, 1.0), 0.0});
    truth.poses.push_back({map_from_camera.Inverse(), 0, i >= options.free_poses});
  }
  while (truth.points.size() < options.points) {
    const double x = Uniform(random, -3.0, 7.0);
    const double y = Uniform(random, -3.0, 3.0);
    const Eigen::Vector3d point_in_map(x, y, Uniform(random, 4.0, 9.0));
    std::vector<BundleObservation> views;
    for (std::size_t i = 0; i < poses; ++i) {
      const Eigen::Vector3d point = truth.poses[i].camera_from_map * point_in_map;
      if (point.z() < 0.5 || !truth.cameras[0].Contains(truth.cameras[0].Project(point))) continue;
      if (Uniform(random, 0.0, 1.0) >= options.seen_ratio) continue;
      const int index = static_cast<int>(truth.points.size());
      views.push_back({static_cast<int>(i), index, Measure(truth.cameras[0], point), 1.0});
    }
    if (views.size() < options.min_views) continue;
    truth.points.push_back({point_in_map, false});
    for (BundleObservation& observation : views) {
      observation.measurement = Disturbed(random, observation.measurement, options.noise);
      const bool no_right = !options.stereo || random() % 3 == 0 || observation.measurement.z() < 0.0;
      if (no_right) observation.measurement.z() = -1.0;
      const bool outlier = Uniform(random, 0.0, 1.0) < options.outlier_ratio;
      if (outlier) {
        const double sign = random() % 2 == 0 ? 1.0 : -1.0;
        observation.measurement.x() += sign * Uniform(random, 20.0, 100.0);
      }
      truth.observations.push_back(observation);
      world.is_outlier.push_back(outlier ? 1 : 0);
    }
  }
  world.problem = truth;
  for (BundlePose& pose : world.problem.poses) {
    if (!pose.fixed)
      pose.camera_from_map = Perturbed(random, pose.camera_from_map, options.pose_error, options.pose_error);
  }
  for (BundlePoint& point : world.problem.points) point.point_in_map += UniformVector(random, options.point_error);
  return world;
}

}  // namespace pangaea::testing
