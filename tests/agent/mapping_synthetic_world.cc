#include "tests/agent/mapping_synthetic_world.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/reprojection.h"
#include "common/geometry/vergence.h"

namespace pangaea::testing {
namespace {

constexpr double kHalfWidth = 5.0;   // metres
constexpr double kHalfHeight = 2.0;  // metres

Eigen::Vector3d PointOnWalls(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Eigen::Vector3d half(kHalfWidth, kHalfWidth, kHalfHeight);
  // Braces, unlike parentheses, draw in order.
  const Eigen::Vector3d share{unit(random), unit(random), unit(random)};
  Eigen::Vector3d point = share.cwiseProduct(half);
  const double side = unit(random) > 0.0 ? 1.0 : -1.0;
  // Four walls of 40 m2, floor and ceiling of 100 m2.
  const double choice = std::uniform_real_distribution<double>(0.0, 360.0)(random);
  const int axis = choice < 80.0 ? 0 : choice < 160.0 ? 1 : 2;
  // Furniture breaks the planes.
  const double depth = std::uniform_real_distribution<double>(0.8, 1.0)(random);
  point[axis] = side * half[axis] * depth;
  return point;
}

}  // namespace

SyntheticWorld::SyntheticWorld(const SyntheticWorldOptions& options)
    : options_(options),
      random_(options.seed),
      camera_{.width = 752,
              .height = 480,
              .focal_x = 435.0,
              .focal_y = 435.0,
              .center_x = 367.0,
              .center_y = 252.0,
              .baseline = options.stereo ? 0.11 : 0.0} {
  std::uniform_real_distribution<double> size(6.0, 12.0);
  for (int i = 0; i < options_.points; ++i) {
    WorldPoint point{.position = PointOnWalls(random_), .descriptor = {}, .size = size(random_)};
    for (auto& word : point.descriptor.words) word = random_();
    world_.push_back(point);
  }
}

void SyntheticWorld::BeginMap(MapId map) {
  map_ = map;
  recent_.clear();
}

KeyframeCandidate SyntheticWorld::NextKeyframe(const Rigid3d& camera_from_world, const Atlas& atlas) {
  View view = Look(camera_from_world);
  KeyframeCandidate candidate;
  candidate.id = {map_.session, ++keyframes_};
  candidate.map = map_;
  candidate.data = view.data;
  view.data->stamp_ns = static_cast<std::int64_t>(keyframes_) * 1'000'000'000;
  if (recent_.empty()) {
    candidate.landmarks.resize(view.points.size());
  } else {
    candidate.reference = recent_.back();
    Vector6d noise;
    for (int i = 0; i < 6; ++i) noise[i] = Normal() * (i < 3 ? options_.position_noise : options_.rotation_noise);
    candidate.camera_from_reference = Rigid3d::Exp(noise) * camera_from_world * poses_.at(recent_.back()).Inverse();
    candidate.landmarks = Follow(view, atlas);
  }
  poses_[candidate.id] = camera_from_world;
  points_[candidate.id] = std::move(view.points);
  recent_.push_back(candidate.id);
  return candidate;
}

SyntheticWorld::View SyntheticWorld::Look(const Rigid3d& camera_from_world) {
  View view{.data = std::make_shared<KeyframeData>(), .points = {}};
  view.data->camera = camera_;
  for (std::size_t i = 0; i < world_.size(); ++i) {
    const Eigen::Vector3d point = camera_from_world * world_[i].position;
    if (point.z() < 0.3 || !camera_.Contains(camera_.Project(point), 4.0)) continue;
    const double octave = world_[i].size - std::log(point.norm()) / std::log(kOctaveScale);
    if (octave < 0.0 || octave >= kOctaves || Uniform() < options_.missed) continue;
    view.data->features.keypoints.push_back(MakeKeypoint(point, static_cast<int>(octave)));
    view.data->features.descriptors.push_back(Disturb(world_[i].descriptor));
    view.points.push_back(static_cast<int>(i));
    if (view.points.size() == options_.max_keypoints) break;
  }
  return view;
}

Keypoint SyntheticWorld::MakeKeypoint(const Eigen::Vector3d& point_in_camera, int octave) {
  const Eigen::Vector2d pixel = camera_.Project(point_in_camera);
  const double sigma = options_.pixel_noise * OctaveSigma(octave);
  Keypoint keypoint{.u = QuantizePixel(pixel.x() + sigma * Normal()),
                    .v = QuantizePixel(pixel.y() + sigma * Normal()),
                    .octave = static_cast<std::uint8_t>(octave)};
  if (camera_.is_stereo()) {
    const double exact = pixel.x() - camera_.focal_x * camera_.baseline / point_in_camera.z();
    // Off as far as the left column, and by the disparity's own error.
    const double error = keypoint.u - pixel.x() - sigma / kDisparityPrecision * Normal();
    const double u_right = exact + VergenceShift(camera_, pixel.x(), options_.vergence) + error;
    if (u_right >= 0.0) keypoint.u_right = QuantizePixel(u_right);
  }
  return keypoint;
}

void SyntheticWorld::Repaint(double kept) {
  for (WorldPoint& point : world_) {
    if (std::uniform_real_distribution<double>()(random_) < kept) continue;
    for (auto& word : point.descriptor.words) word = random_();
  }
}

Descriptor SyntheticWorld::Disturb(Descriptor descriptor) {
  for (auto& word : descriptor.words) {
    for (int bit = 0; bit < 64; ++bit) {
      if (Uniform() < options_.flipped_bits) word ^= std::uint64_t{1} << bit;
    }
  }
  return descriptor;
}

std::map<int, LandmarkId> SyntheticWorld::RecentLandmarks(const Atlas& atlas) const {
  constexpr std::size_t kRecentKeyframes = 3;
  std::map<int, LandmarkId> landmarks;
  for (std::size_t i = recent_.size() - std::min(recent_.size(), kRecentKeyframes); i < recent_.size(); ++i) {
    const Keyframe* keyframe = atlas.FindKeyframe(recent_[i]);
    if (keyframe == nullptr) continue;
    const std::vector<int>& points = points_.at(recent_[i]);
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (keyframe->landmarks[k].valid()) landmarks[points[k]] = keyframe->landmarks[k];
    }
  }
  return landmarks;
}

std::vector<LandmarkId> SyntheticWorld::Follow(const View& view, const Atlas& atlas) {
  const std::map<int, LandmarkId> known = RecentLandmarks(atlas);
  std::vector<LandmarkId> landmarks(view.points.size());
  for (std::size_t k = 0; k < view.points.size(); ++k) {
    const auto landmark = known.find(view.points[k]);
    if (landmark == known.end() || Uniform() > options_.tracked) continue;
    const bool wrong = Uniform() < options_.wrongly_tracked;
    landmarks[wrong ? (k + 1) % landmarks.size() : k] = landmark->second;
  }
  return landmarks;
}

Rigid3d LookAlong(const Eigen::Vector3d& position, double yaw) {
  Eigen::Matrix3d world_from_camera;  // columns: right, down, ahead
  world_from_camera.col(0) = Eigen::Vector3d(std::sin(yaw), -std::cos(yaw), 0.0);
  world_from_camera.col(1) = -Eigen::Vector3d::UnitZ();
  world_from_camera.col(2) = Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0);
  return Rigid3d(Eigen::Quaterniond(world_from_camera), position).Inverse();
}

Rigid3d CirclePose(int k, int n) {
  const double angle = 2.0 * std::numbers::pi * k / n;
  const Eigen::Vector3d position(1.5 * std::cos(angle), 1.5 * std::sin(angle), 0.2 * std::sin(2.0 * angle));
  return LookAlong(position, angle + 0.25 * std::numbers::pi);
}

}  // namespace pangaea::testing
