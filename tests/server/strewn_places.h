#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "common/base/descriptor.h"
#include "common/map/map_edit.h"
#include "tests/map/small_world.h"

namespace pangaea {

// A point of a place, and how it looks.
struct Thing {
  Eigen::Vector3d position;
  Descriptor look;
};

// Things that no other place has, strewn over a block of 60 x 60 x 20 m that begins 10 m before the camera of Survey.
class Strewer {
 public:
  explicit Strewer(std::uint64_t seed) : random_(seed) {}
  Descriptor Look() { return {{random_(), random_(), random_(), random_()}}; }
  Eigen::Vector3d Position(double from_x = -30.0, double to_x = 30.0) {
    return {Uniform(from_x, to_x), Uniform(-30.0, 30.0), Uniform(10.0, 30.0)};
  }
  std::vector<Thing> Things(int count, double from_x = -30.0, double to_x = 30.0) {
    std::vector<Thing> things;
    for (int i = 0; i < count; ++i) things.push_back({Position(from_x, to_x), Look()});
    return things;
  }

 private:
  double Uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  std::mt19937_64 random_;
};

// Map 1 of the session: every thing a landmark that three keyframes see. `map_from_world`: where the session began.
// Landmarks have the number of their thing, from 1.
inline void Survey(SessionId session, const std::vector<Thing>& things, const Rigid3d& map_from_world, Atlas& atlas,
                   bool stereo = true) {
  const auto apply = [&](const MapEdit& edit) {
    const Status status = Apply(edit, atlas);
    ASSERT_TRUE(status) << status.error().message;
  };
  for (std::uint32_t k = 1; k <= 3; ++k) {
    auto data = std::make_shared<KeyframeData>(*MakeData(things.size(), k));
    if (!stereo) data->camera.baseline = 0.0;
    for (std::size_t i = 0; i < things.size(); ++i) {
      data->features.descriptors[i] = things[i].look;
      if (!stereo) data->features.keypoints[i].u_right = -1.0F;
    }
    const Rigid3d pose = k == 1 ? map_from_world.Inverse() : Rigid3d(Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0});
    apply(AddKeyframe{K(k, session), M(1, session), k == 1 ? KeyframeId{} : K(k - 1, session), pose, data});
  }
  for (std::uint32_t i = 0; i < things.size(); ++i) {
    apply(AddLandmark{L(i + 1, session), K(1, session), i, things[i].position});
    for (std::uint32_t k = 2; k <= 3; ++k) apply(AddObservation{L(i + 1, session), K(k, session), i});
  }
}

inline const Rigid3d kWhereBertBegan = MakePose(0.7, 3.0, -2.0, 1.0);

// The same place, all but `kept` of its things looking different now.
inline std::vector<Thing> Repainted(std::vector<Thing> things, std::size_t kept, Strewer& strewer) {
  for (std::size_t i = kept; i < things.size(); ++i) things[i].look = strewer.Look();
  return things;
}

}  // namespace pangaea
