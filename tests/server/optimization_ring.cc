#include "tests/server/optimization_ring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/map/map_edit.h"
#include "tests/estimation/synthetic_world.h"

namespace pangaea::testing {
namespace {

constexpr SessionId kSession = 7;
constexpr double kRadius = 5.0;
constexpr double kWall = 10.0;

double AngleOf(std::uint32_t k, std::uint32_t n) { return 2.0 * std::numbers::pi * k / n; }

// The camera's z axis points away from the centre, its y axis down the map's z axis.
Rigid3d CameraAt(double angle) {
  Eigen::Matrix3d map_from_camera;
  map_from_camera.col(2) = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
  map_from_camera.col(1) = Eigen::Vector3d(0.0, 0.0, -1.0);
  map_from_camera.col(0) = map_from_camera.col(1).cross(map_from_camera.col(2));
  return Rigid3d(Eigen::Quaterniond(map_from_camera), kRadius * map_from_camera.col(2)).Inverse();
}

struct View {
  std::uint32_t keyframe;
  std::uint32_t keypoint;
};

class RingMaker {
 public:
  explicit RingMaker(const RingOptions& options) : options_(options), random_(options.seed) {
    ring_.map = {kSession, 1};
    for (std::uint32_t k = 0; k < options.keyframes; ++k) {
      ring_.keyframes.push_back({kSession, k + 1});
      ring_.camera_from_map[ring_.keyframes.back()] = CameraAt(AngleOf(k, options.keyframes));
      auto data = std::make_shared<KeyframeData>();
      data->stamp_ns = (k + 1) * 100'000'000LL;
      data->camera = options.stereo ? StereoCamera() : MonocularCamera();
      data_.push_back(std::move(data));
    }
  }

  Ring Make() {
    std::vector<std::pair<Eigen::Vector3d, std::vector<View>>> tracks;
    while (tracks.size() < options_.landmarks) {
      const double angle = Uniform(random_, 0.0, 2.0 * std::numbers::pi);
      const double distance = kWall + Uniform(random_, -1.0, 1.0);
      const Eigen::Vector3d point(distance * std::cos(angle), distance * std::sin(angle), Uniform(random_, -1.5, 1.5));
      std::vector<View> views = Look(point, angle);
      if (views.size() >= 3) tracks.emplace_back(point, std::move(views));
    }
    AddKeyframes();
    for (const auto& [point, views] : tracks) AddTrack(point, views);
    return std::move(ring_);
  }

 private:
  void Do(const MapEdit& edit) {
    const Status status = Apply(edit, ring_.atlas);
    ASSERT_TRUE(status) << status.error().message;
  }

  std::vector<View> Look(const Eigen::Vector3d& point, double angle) {
    const std::uint32_t n = options_.keyframes;
    const auto nearest = static_cast<std::uint32_t>(angle / (2.0 * std::numbers::pi) * n);
    std::vector<std::uint32_t> around;
    for (std::uint32_t i = 0; i < std::min(n, options_.spread); ++i) {
      const std::uint32_t k = nearest + n + i - options_.spread / 2;
      if (options_.closed || (k >= n && k < 2 * n)) around.push_back(k % n);
    }
    std::shuffle(around.begin(), around.end(), random_);
    std::vector<View> views;
    for (const std::uint32_t k : around) {
      const Eigen::Vector3d in_camera = ring_.camera_from_map.at(ring_.keyframes[k]) * point;
      if (views.size() == options_.views || in_camera.z() < 0.5) continue;
      if (data_[k]->camera.Contains(data_[k]->camera.Project(in_camera), 20.0)) views.push_back({k, See(k, in_camera)});
    }
    return views;
  }

  std::uint32_t See(std::uint32_t k, const Eigen::Vector3d& in_camera) {
    Eigen::Vector3d measured = Disturbed(random_, Measure(data_[k]->camera, in_camera), options_.noise);
    if (Uniform(random_, 0.0, 1.0) < options_.outliers) measured.y() = Uniform(random_, 0.0, 480.0);
    Keypoint keypoint;
    keypoint.u = QuantizePixel(std::clamp(measured.x(), 0.0, 751.0));
    keypoint.v = QuantizePixel(std::clamp(measured.y(), 0.0, 479.0));
    if (options_.stereo) keypoint.u_right = std::max(0.0F, QuantizePixel(measured.z()));
    data_[k]->features.keypoints.push_back(keypoint);
    data_[k]->features.descriptors.emplace_back();
    return static_cast<std::uint32_t>(data_[k]->features.keypoints.size()) - 1;
  }

  void AddKeyframes() {
    KeyframeId parent;
    for (std::size_t k = 0; k < data_.size(); ++k) {
      const KeyframeId id = ring_.keyframes[k];
      const Rigid3d& pose = ring_.camera_from_map.at(id);
      const Rigid3d from_parent = parent.valid() ? pose * ring_.camera_from_map.at(parent).Inverse() : pose;
      Do(AddKeyframe{id, ring_.map, parent, from_parent, data_[k]});
      parent = id;
    }
  }

  void AddTrack(const Eigen::Vector3d& point, const std::vector<View>& views) {
    const LandmarkId id = {kSession, static_cast<std::uint32_t>(ring_.point_in_map.size()) + 1};
    ring_.point_in_map[id] = point;
    const KeyframeId reference = ring_.keyframes[views.front().keyframe];
    Do(AddLandmark{id, reference, views.front().keypoint, ring_.camera_from_map.at(reference) * point});
    for (std::size_t i = 1; i < views.size(); ++i) {
      Do(AddObservation{id, ring_.keyframes[views[i].keyframe], views[i].keypoint});
    }
  }

  const RingOptions options_;
  Random random_;
  Ring ring_;
  std::vector<std::shared_ptr<KeyframeData>> data_;
};

}  // namespace

Ring MakeRing(const RingOptions& options) { return RingMaker(options).Make(); }

Correction PlaceAt(const Atlas& atlas, MapId map, const std::map<KeyframeId, Similarity3d>& cameras) {
  Correction correction{.base = atlas, .map = map, .keyframes = {}, .landmarks = {}};
  for (const auto& [id, camera] : cameras) {
    const double scale = 1.0 / camera.scale();
    correction.keyframes.push_back({id, Rigid3d(camera.rotation(), scale * camera.translation()), scale});
  }
  return correction;
}

Correction Disturb(const Ring& ring, std::uint64_t seed, double translation, double rotation, double of_points) {
  Random random(seed);
  Correction correction{.base = ring.atlas, .map = ring.map, .keyframes = {}, .landmarks = {}};
  for (std::size_t k = 1; k < ring.keyframes.size(); ++k) {
    const Rigid3d& pose = ring.camera_from_map.at(ring.keyframes[k]);
    correction.keyframes.push_back({ring.keyframes[k], Perturbed(random, pose, translation, rotation)});
  }
  for (const auto& [id, point] : ring.point_in_map) {
    correction.landmarks.push_back({id, point + UniformVector(random, of_points)});
  }
  return correction;
}

std::map<KeyframeId, Similarity3d> Drift(const Ring& ring, const Similarity3d& step_error) {
  std::map<KeyframeId, Similarity3d> cameras;
  for (std::size_t k = 0; k < ring.keyframes.size(); ++k) {
    const Similarity3d truth(ring.camera_from_map.at(ring.keyframes[k]));
    if (k == 0) {
      cameras[ring.keyframes[0]] = truth;
      continue;
    }
    const Similarity3d before(ring.camera_from_map.at(ring.keyframes[k - 1]));
    cameras[ring.keyframes[k]] = step_error * truth * before.Inverse() * cameras.at(ring.keyframes[k - 1]);
  }
  return cameras;
}

Atlas Corrected(const Atlas& atlas, const Correction& correction) {
  Atlas corrected = atlas;
  for (const MapEdit& edit : Rebase(correction, atlas)) {
    const Status status = Apply(edit, corrected);
    EXPECT_TRUE(status) << status.error().message;
  }
  return corrected;
}

double PositionError(const Ring& ring, const Atlas& atlas) {
  double sum = 0.0;
  for (const auto& [id, truth] : ring.camera_from_map) {
    const Rigid3d& pose = atlas.FindKeyframe(id)->camera_from_map;
    sum += (pose.Inverse().translation() - truth.Inverse().translation()).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(ring.camera_from_map.size()));
}

}  // namespace pangaea::testing
