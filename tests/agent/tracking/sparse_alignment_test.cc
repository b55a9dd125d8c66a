#include "agent/tracking/sparse_alignment.h"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "tests/agent/tracking/textured_plane.h"

namespace pangaea {
namespace {

ImagePyramid PyramidOf(const cv::Mat& image) {
  ImagePyramid pyramid;
  BuildImagePyramid(image, 5, pyramid);
  return pyramid;
}

class SparseAlignment : public ::testing::Test {
 protected:
  SparseAlignment() : plane_(2.5, 11), camera_(SmallCamera()) {
    for (double u = 30.0; u < 290.0; u += 16.0) {
      for (double v = 30.0; v < 210.0; v += 16.0) points_.push_back(plane_.PointAt(camera_, Rigid3d(), u, v));
    }
    previous_ = PyramidOf(plane_.Render(camera_, Rigid3d()));
  }

  // The largest distance, in pixels, between where the estimated and the true motion put a point.
  double PixelError(const Rigid3d& estimate, const Rigid3d& truth) const {
    double worst = 0.0;
    for (const Eigen::Vector3d& point : points_) {
      worst = std::max(worst, (camera_.Project(estimate * point) - camera_.Project(truth * point)).norm());
    }
    return worst;
  }

  static Rigid3d Turn(double degrees, const Eigen::Vector3d& axis, const Eigen::Vector3d& shift) {
    return Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis.normalized())), shift);
  }

  TexturedPlane plane_;
  IdealCamera camera_;
  std::vector<Eigen::Vector3d> points_;
  ImagePyramid previous_;
};

TEST_F(SparseAlignment, RecoversAFastTurnWithoutAPrediction) {
  const Rigid3d truth = Turn(2.0, {0.2, 1.0, 0.3}, {0.02, -0.01, 0.03});  // about 9 pixels of flow
  const ImagePyramid current = PyramidOf(plane_.Render(camera_, truth));
  const auto estimate = AlignSparsely(previous_, current, camera_, points_, Rigid3d(), {});
  ASSERT_TRUE(estimate);
  EXPECT_LT(PixelError(*estimate, truth), 1.0);
}

TEST_F(SparseAlignment, StandsStillWhereNothingMoves) {
  const auto estimate = AlignSparsely(previous_, previous_, camera_, points_, Rigid3d(), {});
  ASSERT_TRUE(estimate);
  EXPECT_LT(PixelError(*estimate, Rigid3d()), 0.01);
}

TEST_F(SparseAlignment, ToleratesAChangeOfBrightness) {
  const Rigid3d truth = Turn(1.0, {1.0, 0.0, 0.2}, {0.0, 0.02, 0.0});
  cv::Mat image = plane_.Render(camera_, truth);
  image.convertTo(image, CV_8UC1, 1.0, 15.0);
  const auto estimate = AlignSparsely(previous_, PyramidOf(image), camera_, points_, Rigid3d(), {});
  ASSERT_TRUE(estimate);
  EXPECT_LT(PixelError(*estimate, truth), 1.5);
}

TEST_F(SparseAlignment, SaysNothingWithTooFewPoints) {
  const std::vector<Eigen::Vector3d> few(points_.begin(), points_.begin() + 5);
  EXPECT_FALSE(AlignSparsely(previous_, previous_, camera_, few, Rigid3d(), {}));
  EXPECT_FALSE(AlignSparsely(previous_, previous_, camera_, {}, Rigid3d(), {}));
}

}  // namespace
}  // namespace pangaea
