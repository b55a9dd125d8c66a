#include "agent/tracking/odometry.h"

#include <gtest/gtest.h>

namespace pangaea {
namespace {

Rigid3d Pose(double angle, double x) { return Rigid3d(ExpSo3({0.0, angle, 0.1}), {x, 0.2, 0.3}); }

Rigid3d BodyInMap(const OdometryState& state) {
  const Similarity3d& map_from_odom = state.map_from_odom;
  return Rigid3d(map_from_odom.rotation() * state.odom_from_body.rotation(),
                 map_from_odom * state.odom_from_body.translation());
}

TEST(Odometry, SaysWhereTheBodyIsInTheMapByWayOfOdom) {
  const Rigid3d camera_from_body = Pose(0.5, 0.1);
  Odometry odometry(camera_from_body);
  const Rigid3d first = Pose(0.1, 1.0);
  const Rigid3d second = Pose(0.2, 1.5);
  odometry.Update(first, std::nullopt, 1.0);
  const OdometryState& state = odometry.Update(second, second * first.Inverse(), 1.0);
  EXPECT_FALSE(state.discontinuity);
  EXPECT_LT((BodyInMap(state).Matrix() - (second.Inverse() * camera_from_body).Matrix()).norm(), 1e-12);
}

TEST(Odometry, DoesNotJumpWhenTheMapDoes) {
  Odometry odometry(Rigid3d{});
  const Rigid3d first = Pose(0.1, 1.0);
  const Rigid3d motion = Pose(0.01, 0.05);
  odometry.Update(first, std::nullopt, 1.0);
  const Rigid3d before = odometry.Update(motion * first, motion, 1.0).odom_from_body;
  // The map turns and moves by metres; the camera goes on as it did.
  const Rigid3d jumped = motion * motion * first * Pose(1.0, 3.0);
  const OdometryState& state = odometry.Update(jumped, motion, 1.0);
  const Rigid3d previous_from_current = before.Inverse() * state.odom_from_body;
  EXPECT_LT((previous_from_current.Matrix() - motion.Inverse().Matrix()).norm(), 1e-12);
  EXPECT_LT((BodyInMap(state).Matrix() - jumped.Inverse().Matrix()).norm(), 1e-12);
}

TEST(Odometry, KeepsItsScaleWhenTheMapGetsOne) {
  Odometry odometry(Rigid3d{});
  const Rigid3d first;
  const Rigid3d step(Eigen::Quaterniond::Identity(), {-0.1, 0.0, 0.0});  // the camera goes 0.1 to the right
  odometry.Update(first, std::nullopt, 1.0);
  odometry.Update(step, step, 1.0);
  // Lengths of the map are three times what they were.
  const Rigid3d scaled(Eigen::Quaterniond::Identity(), {-0.6, 0.0, 0.0});
  const Rigid3d scaled_step(Eigen::Quaterniond::Identity(), {-0.3, 0.0, 0.0});
  const OdometryState& state = odometry.Update(scaled, scaled_step, 3.0);
  EXPECT_NEAR(state.odom_from_body.translation().x(), 0.2, 1e-12);
  EXPECT_EQ(state.map_from_odom.scale(), 3.0);
  EXPECT_NEAR(BodyInMap(state).translation().x(), 0.6, 1e-12);
}

TEST(Odometry, SaysSoWhereAMotionIsNotKnown) {
  Odometry odometry(Rigid3d{});
  EXPECT_FALSE(odometry.Update(Pose(0.1, 1.0), std::nullopt, 1.0).discontinuity);
  const Rigid3d before = odometry.state().odom_from_body;
  EXPECT_TRUE(odometry.Update(Rigid3d(), std::nullopt, 1.0).discontinuity);
  EXPECT_EQ(odometry.state().odom_from_body.translation(), before.translation());
}

}  // namespace
}  // namespace pangaea
