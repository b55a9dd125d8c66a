#include "tests/map/small_world.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "common/map/atlas_codec.h"
#include "common/map/consistency.h"

namespace pangaea {

std::shared_ptr<const KeyframeData> MakeData(std::size_t keypoints, std::int64_t stamp_ns) {
  auto data = std::make_shared<KeyframeData>();
  data->stamp_ns = stamp_ns;
  data->camera = {752, 480, 435.2, 435.2, 367.4, 252.2, 0.11};
  for (std::size_t i = 0; i < keypoints; ++i) {
    Keypoint keypoint;
    keypoint.u = QuantizePixel(30.0 + static_cast<double>(i * 37 % 700) + 0.21);
    keypoint.v = QuantizePixel(static_cast<double>(i * 53 % 470) + 0.77);
    if (i % 2 == 0) keypoint.u_right = QuantizePixel(keypoint.u - 12.3);
    keypoint.octave = static_cast<std::uint8_t>(i % kOctaves);
    keypoint.angle = static_cast<std::uint8_t>(i * 11);
    data->features.keypoints.push_back(keypoint);
    data->features.descriptors.push_back({{i, i * i, ~i, static_cast<std::uint64_t>(stamp_ns)}});
  }
  return data;
}

Rigid3d MakePose(double angle, double x, double y, double z) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, 2.0, -0.5).normalized();
  return Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), {x, y, z});
}

void SmallWorld::Do(const MapEdit& edit) {
  const std::uint64_t version = atlas.version();
  const Status status = Apply(edit, atlas);
  ASSERT_TRUE(status) << KindName(edit) << ": " << status.error().message;
  ASSERT_EQ(atlas.version(), version + 1);
  const auto faults = CheckConsistency(atlas);
  ASSERT_TRUE(faults.empty()) << KindName(edit) << ": " << faults.front();
}

void SmallWorld::Refuse(const MapEdit& edit, ErrorCode code) {
  const auto before = Fingerprint(atlas);
  const Status status = Apply(edit, atlas);
  ASSERT_FALSE(status) << KindName(edit) << " was taken";
  EXPECT_EQ(status.error().code, code) << status.error().message;
  EXPECT_EQ(Fingerprint(atlas), before);
}

void SmallWorld::Root(KeyframeId id, MapId map, std::size_t keypoints) {
  Do(AddKeyframe{id, map, {}, MakePose(0.3, 1.0, 2.0, 3.0), MakeData(keypoints, id.counter * 1000)});
}

void SmallWorld::Child(KeyframeId id, KeyframeId parent, MapId map, std::size_t keypoints) {
  Do(AddKeyframe{id, map, parent, MakePose(0.05, 0.5, 0.0, 0.01), MakeData(keypoints, id.counter * 1000)});
}

void SmallWorld::Add(LandmarkId id, KeyframeId reference, std::uint32_t keypoint) {
  Do(AddLandmark{id, reference, keypoint, {0.1 * id.counter, -0.2, 4.0}});
}

void SmallWorld::Observe(LandmarkId id, KeyframeId keyframe, std::uint32_t keypoint) {
  Do(AddObservation{id, keyframe, keypoint});
}

const Keyframe& SmallWorld::Get(KeyframeId id) const { return *atlas.FindKeyframe(id); }
const Landmark& SmallWorld::Get(LandmarkId id) const { return *atlas.FindLandmark(id); }

SmallWorld RowOfThree() {
  SmallWorld world;
  world.Root(K(1), M(1));
  world.Child(K(2), K(1), M(1));
  world.Child(K(3), K(2), M(1));
  world.Add(L(1), K(1), 1);
  world.Observe(L(1), K(2), 1);
  world.Add(L(2), K(2), 2);
  world.Observe(L(2), K(3), 2);
  world.Add(L(3), K(3), 3);
  return world;
}

std::vector<std::byte> Fingerprint(const Atlas& atlas) { return EncodeAtlas(atlas); }

bool SameBits(const Rigid3d& a, const Rigid3d& b) {
  return a.rotation().coeffs() == b.rotation().coeffs() && a.translation() == b.translation();
}

}  // namespace pangaea
