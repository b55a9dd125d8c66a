#include "common/geometry/similarity3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pangaea {
namespace {

const Similarity3d kTargetFromSource(2.5, ExpSo3({0.3, -0.2, 1.1}), {1.0, -2.0, 0.5});
const Similarity3d kOther(0.4, ExpSo3({-1.3, 0.2, 0.1}), {0.0, 3.0, -4.0});

TEST(Similarity3d, InverseAndCompositionActOnPointsInTurn) {
  const Eigen::Vector3d point(0.3, 4.0, -2.0);
  EXPECT_LT((kTargetFromSource.Inverse() * (kTargetFromSource * point) - point).norm(), 1e-12);
  EXPECT_LT(((kOther * kTargetFromSource) * point - kOther * (kTargetFromSource * point)).norm(), 1e-12);
}

TEST(Similarity3d, ACameraThatMovesWithItsMapSeesTheSameImage) {
  const Rigid3d camera_from_source(ExpSo3({0.1, 0.7, -0.4}), {0.2, 0.1, 5.0});
  const Rigid3d camera_from_target = kTargetFromSource.TransformCamera(camera_from_source);
  for (const Eigen::Vector3d& point : {Eigen::Vector3d(1.0, 2.0, 3.0), Eigen::Vector3d(-1.0, 0.5, 9.0)}) {
    const Eigen::Vector3d before = camera_from_source * point;
    const Eigen::Vector3d after = camera_from_target * (kTargetFromSource * point);
    EXPECT_LT((after - kTargetFromSource.scale() * before).norm(), 1e-12);
  }
}

TEST(Similarity3d, WhatWasNormalisedIsReadBackWithEveryBit) {
  const auto read = Similarity3d::FromNormalized(kOther.scale(), kOther.rotation(), kOther.translation());
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->scale(), kOther.scale());
  EXPECT_EQ(read->rotation().coeffs(), kOther.rotation().coeffs());
  EXPECT_EQ(read->translation(), kOther.translation());
}

TEST(Similarity3d, AScaleThatIsNotPositiveIsNotTaken) {
  for (const double scale : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_FALSE(Similarity3d::FromNormalized(scale, kOther.rotation(), kOther.translation()).has_value());
  }
}

}  // namespace
}  // namespace pangaea
