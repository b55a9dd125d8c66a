#include "common/sensor/lens.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

namespace pangaea {
namespace {

LensModel WideAngle() {
  return {.kind = LensKind::kRadialTangential,
          .width = 752,
          .height = 480,
          .focal_x = 458.654,
          .focal_y = 457.296,
          .center_x = 367.215,
          .center_y = 248.375,
          .coefficients = {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0}};
}

LensModel Fisheye() {
  return {.kind = LensKind::kEquidistant,
          .width = 512,
          .height = 512,
          .focal_x = 190.978,
          .focal_y = 190.973,
          .center_x = 254.931,
          .center_y = 256.897,
          .coefficients = {0.0034823894, 0.0007150348, -0.0020532361, 0.00020293673, 0.0}};
}

TEST(Lens, UndistortingWhatALensDistortedGivesTheRayBack) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  for (const LensModel& lens : {WideAngle(), Fisheye()}) {
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector2d point{coordinate(random), 0.7 * coordinate(random)};  // braces draw in order
      const auto back = lens.Undistort(lens.Distort(point));
      ASSERT_TRUE(back);
      EXPECT_LT((*back - point).norm(), 1e-9);
    }
  }
}

TEST(Lens, EveryPixelOfAWideAngleImageHasARay) {
  const LensModel lens = WideAngle();
  for (int v = 0; v < lens.height; v += 31) {
    for (int u = 0; u < lens.width; u += 47) {
      const auto ray = lens.Unproject(Eigen::Vector2d(u, v));
      ASSERT_TRUE(ray) << u << " " << v;
      EXPECT_LT((lens.Project(ray->homogeneous()) - Eigen::Vector2d(u, v)).norm(), 1e-6);
    }
  }
}

TEST(Lens, AnEquidistantLensProjectsAnglesOntoDistances) {
  LensModel lens = Fisheye();
  lens.coefficients = {};
  const double angle = 1.2;
  const Eigen::Vector2d pixel = lens.Project({std::sin(angle), 0.0, std::cos(angle)});
  EXPECT_NEAR(pixel.x(), lens.center_x + lens.focal_x * angle, 1e-9);
  EXPECT_NEAR(pixel.y(), lens.center_y, 1e-9);
}

TEST(Lens, PixelsBeyondARightAngleHaveNoRay) { EXPECT_FALSE(Fisheye().Unproject({254.931 + 1.6 * 190.978, 256.897})); }

TEST(Lens, ALensThatFoldsOverSaysWhere) {
  LensModel lens = WideAngle();
  EXPECT_TRUE(std::isinf(lens.FoldingRadius()));
  lens.coefficients = {-0.3, 0.0, 0.0, 0.0, 0.0};  // r - 0.3 r^3 is largest at r = 1 / sqrt(0.9)
  EXPECT_NEAR(lens.FoldingRadius(), 1.0 / std::sqrt(0.9), 0.01);
  EXPECT_FALSE(lens.Undistort({0.9, 0.0}));
}

TEST(Lens, ImpossibleNumbersAreRefusedWithTheirPlace) {
  EXPECT_TRUE(WideAngle().Check("cam0"));
  LensModel lens = WideAngle();
  lens.focal_x = 0.0;
  EXPECT_THAT(lens.Check("cam0").error().message, testing::HasSubstr("cam0"));
  lens = WideAngle();
  lens.coefficients[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(lens.Check("cam0"));
  lens = WideAngle();
  lens.width = 0;
  EXPECT_FALSE(lens.Check("cam0"));
}

}  // namespace
}  // namespace pangaea
