#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <variant>
#include <vector>

#include "common/map/atlas.h"
#include "common/map/map_edit.h"

// A small map for tests of single steps: keyframes side by side that look at one wall, everything exact.
namespace pangaea::testing {

inline constexpr SessionId kSession = 1;
inline constexpr MapId kMap{kSession, 1};

inline const IdealCamera kCamera{.width = 640,
                                 .height = 480,
                                 .focal_x = 400.0,
                                 .focal_y = 400.0,
                                 .center_x = 320.0,
                                 .center_y = 240.0,
                                 .baseline = 0.1};

inline KeyframeId Kf(std::uint32_t counter) { return {kSession, counter}; }
inline LandmarkId Lm(std::uint32_t counter) { return {kSession, counter}; }

// A descriptor unlike those of other seeds.
inline Descriptor MakeDescriptor(std::uint64_t seed) {
  Descriptor descriptor;
  for (auto& word : descriptor.words) {
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    word = seed ^ (seed >> 29);
  }
  return descriptor;
}

// A keyframe that sees points (in the map frame) without noise, keypoint i with the descriptor of seed i + 1.
inline std::shared_ptr<KeyframeData> See(const std::vector<Eigen::Vector3d>& points, const Rigid3d& camera_from_map,
                                         std::int64_t stamp, const IdealCamera& camera = kCamera) {
  auto data = std::make_shared<KeyframeData>();
  data->stamp_ns = stamp;
  data->camera = camera;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d point = camera_from_map * points[i];
    const Eigen::Vector2d pixel = camera.Project(point);
    Keypoint keypoint{.u = QuantizePixel(pixel.x()), .v = QuantizePixel(pixel.y())};
    if (camera.is_stereo()) keypoint.u_right = QuantizePixel(pixel.x() - camera.focal_x * camera.baseline / point.z());
    data->features.keypoints.push_back(keypoint);
    data->features.descriptors.push_back(MakeDescriptor(i + 1));
  }
  return data;
}

inline Rigid3d At(double x, double y = 0.0, double z = 0.0) {
  return Rigid3d(Eigen::Quaterniond::Identity(), Eigen::Vector3d(-x, -y, -z));
}

inline std::vector<Eigen::Vector3d> Wall(int columns, int rows, double depth) {
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      points.emplace_back(0.3 * (column - 0.5 * columns), 0.3 * (row - 0.5 * rows),
                          depth + 0.05 * ((row + column) % 3));
    }
  }
  return points;
}

inline void Do(Atlas& atlas, const std::vector<MapEdit>& edits) {
  for (const MapEdit& edit : edits) {
    const Status status = Apply(edit, atlas);
    ASSERT_TRUE(status.has_value()) << status.error().message;
  }
}

// The root of a map at the origin and, below it, keyframes at the given places; all see the same points.
class WallMap : public ::testing::Test {
 protected:
  void Build(const std::vector<double>& places, bool observe) {
    for (std::size_t k = 0; k < places.size(); ++k) {
      const auto counter = static_cast<std::uint32_t>(k + 1);
      const KeyframeId parent = k == 0 ? KeyframeId{} : Kf(counter - 1);
      const Rigid3d parent_pose = k == 0 ? Rigid3d() : At(places[k - 1]);
      Do(atlas_, {AddKeyframe{.id = Kf(counter),
                              .map = kMap,
                              .parent = parent,
                              .camera_from_parent = At(places[k]) * parent_pose.Inverse(),
                              .data = See(points_, At(places[k]), counter)}});
      for (std::uint32_t i = 0; i < points_.size() && observe; ++i) {
        if (k == 0) Do(atlas_, {AddLandmark{Lm(i + 1), Kf(1), i, At(places[0]) * points_[i]}});
        if (k > 0) Do(atlas_, {AddObservation{Lm(i + 1), Kf(counter), i}});
      }
    }
  }
  const Keyframe& Get(std::uint32_t counter) const { return *atlas_.FindKeyframe(Kf(counter)); }

  std::vector<Eigen::Vector3d> points_ = Wall(8, 6, 3.0);
  Atlas atlas_;
};

template <typename Kind>
std::size_t Count(const std::vector<MapEdit>& edits) {
  return static_cast<std::size_t>(std::count_if(
      edits.begin(), edits.end(), [](const MapEdit& edit) { return std::holds_alternative<Kind>(edit); }));
}

}  // namespace pangaea::testing
