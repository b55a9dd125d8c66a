#include "agent/tracking/latest_frame.h"

#include <gtest/gtest.h>

#include "tests/agent/tracking/keyframe_chain.h"

namespace pangaea {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

// A frame one metre behind keyframe 1, after which the camera moves on at two metres a second.
LatestFrame Behind() {
  LatestFrame frame;
  frame.reference = Kept(1);
  frame.reference_from_frame = At(-1.0).Inverse();
  frame.stamp_ns = kSecond;
  frame.velocity << -2.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  frame.points_in_camera = {{0.0, 0.0, 3.0}};
  return frame;
}

TEST(LatestFrame, ItsPoseFollowsItsReference) {
  Atlas atlas = Chain(1);
  EXPECT_EQ(Behind().PoseIn(Atlas{}), std::nullopt);
  EXPECT_LT((*Behind().PoseIn(atlas) * At(-1.0).Inverse()).Log().norm(), 1e-12);
  Move(Kept(1), At(5.0), 1.0, atlas);
  EXPECT_LT((*Behind().PoseIn(atlas) * At(4.0).Inverse()).Log().norm(), 1e-12);
}

TEST(LatestFrame, WhereTheMapIsScaledItsLengthsAreOnce) {
  Atlas atlas = Chain(1);
  Move(Kept(1), At(0.0), 2.0, atlas);
  LatestFrame frame = Behind();
  for (int i = 0; i < 2; ++i) frame.FollowScale(atlas);
  EXPECT_LT((*frame.PoseIn(atlas) * At(-2.0).Inverse()).Log().norm(), 1e-12);
  EXPECT_EQ(frame.velocity[0], -4.0);
  EXPECT_EQ(frame.points_in_camera[0].z(), 6.0);
}

TEST(LatestFrame, TheMotionGoesOnAsItWas) {
  const LatestFrame frame = Behind();
  const Rigid3d motion = frame.MotionUntil(frame.stamp_ns + kSecond / 2);
  EXPECT_LT((motion * At(1.0).Inverse()).Log().norm(), 1e-12);
  EXPECT_LT((frame.MotionUntil(frame.stamp_ns)).Log().norm(), 1e-12);
}

TEST(LatestFrame, TheVelocityIsThatBetweenTwoFramesOfOneMap) {
  const Atlas atlas = Chain(1);
  const LatestFrame frame = Behind();
  const std::int64_t later = frame.stamp_ns + kSecond / 2;
  EXPECT_NEAR(frame.VelocityInto(later, At(2.0), kMap, atlas)[0], -6.0, 1e-12);
  EXPECT_EQ(frame.VelocityInto(later, At(2.0), {kSession, 9}, atlas), Vector6d::Zero());
  EXPECT_EQ(frame.VelocityInto(frame.stamp_ns, At(2.0), {kSession, 9}, atlas), frame.velocity) << "the same frame";
}

}  // namespace
}  // namespace pangaea
