#include "common/geometry/rigid3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace pangaea {
namespace {

Vector6d RandomTwist(std::mt19937_64& random, double rotation_scale) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Vector6d twist;
  for (double& value : twist) value = uniform(random);
  twist.head<3>() *= 10.0;
  twist.tail<3>() *= rotation_scale;
  return twist;
}

TEST(Rigid3d, LogUndoesExp) {
  std::mt19937_64 random(1);
  for (const double scale : {1.7, 1e-3, 1e-7, 0.0}) {
    for (int i = 0; i < 200; ++i) {
      const Vector6d twist = RandomTwist(random, scale);
      EXPECT_LT((Rigid3d::Exp(twist).Log() - twist).norm(), 1e-9) << twist.transpose();
    }
  }
}

TEST(Rigid3d, LogOfHalfATurnHasTheLengthPi) {
  const Rigid3d half_turn(Eigen::Quaterniond(0.0, 0.0, 1.0, 0.0), Eigen::Vector3d::Zero());
  EXPECT_NEAR(half_turn.Log().tail<3>().norm(), M_PI, 1e-12);
}

TEST(Rigid3d, ExpAgreesWithThePowerSeriesOfTheMatrix) {
  std::mt19937_64 random(2);
  const Vector6d twist = RandomTwist(random, 1.0);
  Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
  generator.topLeftCorner<3, 3>() = Skew(twist.tail<3>());
  generator.topRightCorner<3, 1>() = twist.head<3>();
  Eigen::Matrix4d sum = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d term = Eigen::Matrix4d::Identity();
  for (int n = 1; n < 40; ++n) sum += term = term * generator / n;
  EXPECT_LT((Rigid3d::Exp(twist).Matrix() - sum).norm(), 1e-11);
}

TEST(Rigid3d, CompositionAndInverseAreThoseOfMatrices) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 100; ++i) {
    const Rigid3d a = Rigid3d::Exp(RandomTwist(random, 2.0));
    const Rigid3d b = Rigid3d::Exp(RandomTwist(random, 2.0));
    EXPECT_LT(((a * b).Matrix() - a.Matrix() * b.Matrix()).norm(), 1e-12);
    EXPECT_LT((a.Inverse().Matrix() * a.Matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-12);
    const Eigen::Vector3d point = RandomTwist(random, 1.0).head<3>();
    EXPECT_LT(((a * b) * point - a * (b * point)).norm(), 1e-12);
    EXPECT_GE((a * b).rotation().w(), 0.0);
  }
}

TEST(Rigid3d, WhatWasNormalisedIsReadBackWithEveryBit) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 1000; ++i) {
    const Rigid3d rigid = Rigid3d::Exp(RandomTwist(random, 3.0));
    const auto read = Rigid3d::FromNormalized(rigid.rotation(), rigid.translation());
    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(read->rotation().coeffs(), rigid.rotation().coeffs());
    EXPECT_EQ(read->translation(), rigid.translation());
  }
}

TEST(Rigid3d, NumbersThatAreNoRotationAreNotTaken) {
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Rigid3d::FromNormalized(Eigen::Quaterniond(1.0001, 0.0, 0.0, 0.0), zero).has_value());
  EXPECT_FALSE(Rigid3d::FromNormalized(Eigen::Quaterniond(0.0, 0.0, 0.0, 0.0), zero).has_value());
  EXPECT_FALSE(Rigid3d::FromNormalized(Eigen::Quaterniond(-1.0, 0.0, 0.0, 0.0), zero).has_value());
  EXPECT_FALSE(Rigid3d::FromNormalized(Eigen::Quaterniond(nan, 0.0, 0.0, 0.0), zero).has_value());
}

}  // namespace
}  // namespace pangaea
