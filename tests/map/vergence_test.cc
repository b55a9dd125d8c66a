#include "common/geometry/vergence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/base/bytes.h"
#include "common/map/forgetting.h"
#include "common/map/keyframe_codec.h"
#include "common/map/keyframe_vergence.h"
#include "common/map/limits.h"
#include "common/map/map_edit.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

// What a keyframe saw in the middle, at the right and at the left edge of its image.
std::shared_ptr<const KeyframeData> ThreePoints() {
  auto data = std::make_shared<KeyframeData>();
  data->camera = {752, 480, 400.0, 400.0, 376.0, 240.0, 0.1};
  data->features.keypoints = {{.u = 376.0F, .v = 240.0F, .u_right = 366.0F},
                              {.u = 751.0F, .v = 100.0F, .u_right = 741.0F},
                              {.u = 6.0F, .v = 100.0F, .u_right = 1.0F},
                              {.u = 300.0F, .v = 100.0F}};
  data->features.descriptors.resize(4);
  return data;
}

TEST(Vergence, ShiftsColumnsAsARayTurns) {
  const IdealCamera camera = ThreePoints()->camera;
  for (const double u : {0.0, 200.0, 376.0, 751.0}) {
    const double angle = std::atan2(u - camera.center_x, camera.focal_x);
    const double turned = camera.focal_x * std::tan(angle + 0.001) + camera.center_x;
    EXPECT_NEAR(VergenceShift(camera, u, 0.001), turned - u, 2e-3 * (turned - u));
  }
}

TEST(Vergence, MovesRightColumnsAloneAndMoreTowardsTheEdge) {
  const auto before = ThreePoints();
  const auto after = WithVergence(before, 0.005);
  EXPECT_EQ(after->vergence, 0.005);
  EXPECT_EQ(after->features.keypoints[0].u_right, 364.0F);
  EXPECT_FLOAT_EQ(after->features.keypoints[1].u_right,
                  741.0F - QuantizePixel(VergenceShift(before->camera, 751.0, 0.005)));
  EXPECT_LT(after->features.keypoints[1].u_right, 738.0F);
  EXPECT_FALSE(after->features.keypoints[2].has_depth()) << "it would lie left of the image";
  EXPECT_FALSE(after->features.keypoints[3].has_depth());
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(after->features.keypoints[i].u, before->features.keypoints[i].u);
    EXPECT_EQ(after->features.keypoints[i].v, before->features.keypoints[i].v);
  }
}

TEST(Vergence, ADisparityOfNothingIsNone) {
  EXPECT_FALSE(WithVergence(ThreePoints(), -0.03)->features.keypoints[0].has_depth());
}

TEST(Vergence, TheWayToItDoesNotMatter) {
  const auto direct = WithVergence(ThreePoints(), 0.003);
  auto by_detours = ThreePoints();
  for (const double vergence : {0.0001, -0.0007, 0.0011, 0.003}) by_detours = WithVergence(by_detours, vergence);
  EXPECT_EQ(by_detours->features, direct->features);
  const auto back = WithVergence(WithVergence(ThreePoints(), 0.002), 0.0);
  EXPECT_EQ(back->features.keypoints[0], ThreePoints()->features.keypoints[0]);
  EXPECT_EQ(WithVergence(direct, 0.003), direct) << "not even a copy";
}

TEST(Vergence, OneCameraHasNone) {
  auto monocular = std::make_shared<KeyframeData>(*ThreePoints());
  monocular->camera.baseline = 0.0;
  EXPECT_EQ(WithVergence(monocular, 0.01)->vergence, 0.0);
}

TEST(Vergence, TravelsWithTheKeyframe) {
  const auto sent = WithVergence(ThreePoints(), 0.00123);
  ByteWriter writer;
  EncodeKeyframeData(*sent, writer);
  ByteReader reader(writer.bytes());
  const auto read = DecodeKeyframeData(reader);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ((*read)->vergence, sent->vergence);
  EXPECT_EQ((*read)->features, sent->features);
}

TEST(SetVergence, ReachesAllKeyframesOfTheSessionAndNoOthers) {
  SmallWorld world = RowOfThree();
  world.Root(K(1, kBert), M(1, kBert));
  const SmallWorld before = world;
  world.Do(SetVergence{kAnna, 0.004});
  for (const std::uint32_t k : {1U, 2U, 3U}) {
    EXPECT_EQ(world.Get(K(k)).data->features, WithVergence(before.Get(K(k)).data, 0.004)->features);
    EXPECT_EQ(world.Get(K(k)).data->vergence, 0.004);
    EXPECT_TRUE(SameBits(world.Get(K(k)).camera_from_map, before.Get(K(k)).camera_from_map));
  }
  EXPECT_EQ(world.Get(K(1, kBert)).data, before.Get(K(1, kBert)).data);
  EXPECT_EQ(before.Get(K(1)).data->vergence, 0.0) << "a snapshot stays as it was";
}

TEST(SetVergence, AForgottenKeyframeComesBackWithIt) {
  SmallWorld world = RowOfThree();
  const auto was = world.Get(K(3)).data;
  Forget(world.atlas, std::vector<ForgottenKeyframe>{{K(3)}});
  world.Do(SetVergence{kAnna, 0.004});
  world.Do(AddKeyframe{K(3), M(1), {}, {}, was});
  EXPECT_EQ(world.Get(K(3)).data->features, WithVergence(was, 0.004)->features);
}

TEST(SetVergence, WhatNoRigCanHaveIsRefused) {
  SmallWorld world = RowOfThree();
  for (const double vergence :
       {std::nan(""), std::numeric_limits<double>::infinity(), 1.01 * kMaxVergence, -1.01 * kMaxVergence}) {
    world.Refuse(SetVergence{kAnna, vergence}, ErrorCode::kInvalidArgument);
  }
  world.Refuse(SetVergence{0, 0.001}, ErrorCode::kInvalidArgument);
  world.Do(SetVergence{0xc, 0.001});  // a session that has no keyframe here any more
}

TEST(SetVergence, IsTheSessionsOwn) {
  EXPECT_TRUE(TouchesOnly(SetVergence{kAnna, 0.001}, kAnna));
  EXPECT_FALSE(TouchesOnly(SetVergence{kBert, 0.001}, kAnna));
}

}  // namespace
}  // namespace pangaea
