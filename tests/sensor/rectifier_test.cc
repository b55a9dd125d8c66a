#include "common/sensor/rectifier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <random>

#include "tests/sensor/rigs.h"

namespace pangaea {
namespace {

// The image that a real camera takes of a smooth pattern painted on the directions of rays, so that the rectified
// image is known at every pixel.
double Pattern(const Eigen::Vector3d& ray_in_body) {
  const Eigen::Vector3d ray = ray_in_body.normalized();
  return 128.0 + 50.0 * std::sin(31.0 * ray.x() + 3.0) + 40.0 * std::sin(37.0 * ray.y()) +
         20.0 * std::sin(29.0 * ray.z());
}

cv::Mat Photograph(const LensModel& lens, const Rigid3d& body_from_camera) {
  cv::Mat image(lens.height, lens.width, CV_8UC1);
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const auto ray = lens.Unproject(Eigen::Vector2d(u, v));
      image.at<std::uint8_t>(v, u) =
          ray ? static_cast<std::uint8_t>(std::lround(Pattern(body_from_camera.rotation() * ray->homogeneous()))) : 0;
    }
  }
  return image;
}

// The pixel of the target image whose content comes from `source_pixel`, found in a photograph of a single blob.
Eigen::Vector2d RectifiedBlob(const Eigen::Vector2d& source_pixel, const LensModel& lens,
                              const std::function<cv::Mat(const cv::Mat&)>& rectify) {
  cv::Mat image(lens.height, lens.width, CV_8UC1);
  constexpr double kSigma = 2.0;
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const double squared = (Eigen::Vector2d(u, v) - source_pixel).squaredNorm();
      image.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(255.0 * std::exp(-0.5 * squared / (kSigma * kSigma)));
    }
  }
  const cv::Moments moments = cv::moments(rectify(image));
  return {moments.m10 / moments.m00, moments.m01 / moments.m00};
}

class RectifierOfRig : public ::testing::TestWithParam<CameraRig> {};
INSTANTIATE_TEST_SUITE_P(Lenses, RectifierOfRig, ::testing::Values(testing::DroneRig(), testing::FisheyeRig()),
                         [](const auto& rig) { return rig.index == 0 ? "RadialTangential" : "Equidistant"; });

TEST_P(RectifierOfRig, BothViewsOfAPointLieInOneRowAtTheDisparityOfItsDepth) {
  const CameraRig& rig = GetParam();
  const auto rectifier = Rectifier::Create(rig, SensorKind::kStereo);
  ASSERT_TRUE(rectifier) << rectifier.error().message;
  const IdealCamera& camera = rectifier->camera();
  EXPECT_NEAR(camera.baseline, (rig.body_from_left.translation() - rig.body_from_right.translation()).norm(), 1e-12);
  const Eigen::Vector2d size(camera.width, camera.height);
  for (const Eigen::Vector2d& place :
       {Eigen::Vector2d(0.3, 0.25), Eigen::Vector2d(0.5, 0.5), Eigen::Vector2d(0.7, 0.75), Eigen::Vector2d(0.4, 0.8)}) {
    const Eigen::Vector2d pixel = place.cwiseProduct(size);
    const Eigen::Vector3d point_in_camera = 4.0 * camera.Unproject(pixel);
    const Eigen::Vector3d point_in_body = rectifier->body_from_camera() * point_in_camera;
    const Eigen::Vector2d left = RectifiedBlob(rig.left.Project(rig.body_from_left.Inverse() * point_in_body), rig.left,
                                               [&](const cv::Mat& image) { return rectifier->RectifyLeft(image); });
    const Eigen::Vector2d right =
        RectifiedBlob(rig.right->Project(rig.body_from_right.Inverse() * point_in_body), *rig.right,
                      [&](const cv::Mat& image) { return rectifier->RectifyRight(image); });
    const double disparity = camera.focal_x * camera.baseline / point_in_camera.z();
    EXPECT_NEAR(left.y(), right.y(), 0.02) << pixel.transpose();
    EXPECT_NEAR(left.x() - right.x(), disparity, 0.03) << pixel.transpose();
    // The blob's centre of mass is a little off its peak where the lens bends it, and more so where it bends it more.
    EXPECT_LT((left - pixel).norm(), rig.left.kind == LensKind::kEquidistant ? 0.4 : 0.06) << pixel.transpose();
  }
}

TEST_P(RectifierOfRig, ARectifiedImageIsThatOfTheIdealCamera) {
  const CameraRig& rig = GetParam();
  for (const SensorKind kind : {SensorKind::kStereo, SensorKind::kMonocular}) {
    const auto rectifier = Rectifier::Create(rig, kind);
    ASSERT_TRUE(rectifier) << rectifier.error().message;
    const cv::Mat rectified = rectifier->RectifyLeft(Photograph(rig.left, rig.body_from_left));
    const Rigid3d& body_from_camera = rectifier->body_from_camera();
    double worst = 0.0;
    double sum = 0.0;
    for (int v = 0; v < rectified.rows; ++v) {
      for (int u = 0; u < rectified.cols; ++u) {
        const Eigen::Vector3d ray = rectifier->camera().Unproject(Eigen::Vector2d(u, v));
        const double error = rectified.at<std::uint8_t>(v, u) - Pattern(body_from_camera.rotation() * ray);
        worst = std::max(worst, std::abs(error));
        sum += error;
      }
    }
    EXPECT_LT(worst, 4.0);  // of 256: nowhere black, and bilinear interpolation of a smooth pattern
    EXPECT_LT(std::abs(sum / static_cast<double>(rectified.total())), 0.1);
  }
}

TEST(Rectifier, TheIdealCameraLosesLittleDetailAndHasSquarePixels) {
  const CameraRig rig = testing::DroneRig();
  const IdealCamera camera = Rectifier::Create(rig, SensorKind::kStereo)->camera();
  EXPECT_EQ(camera.width, rig.left.width);
  EXPECT_EQ(camera.height, rig.left.height);
  EXPECT_EQ(camera.focal_x, camera.focal_y);
  EXPECT_GT(camera.focal_x, 0.9 * rig.left.focal_x - 1e-9);
  EXPECT_LT(camera.focal_x, 1.05 * rig.left.focal_x);
  RectifierOptions sharp;
  sharp.min_focal_ratio = 1.0;
  EXPECT_GE(Rectifier::Create(rig, SensorKind::kStereo, sharp)->camera().focal_x, rig.left.focal_x);
}

TEST(Rectifier, ImagesThatAreRectifiedAlreadyAreNotCopied) {
  CameraRig rig;
  rig.left = {.width = 64, .height = 48, .focal_x = 50, .focal_y = 51, .center_x = 30, .center_y = 25};
  rig.right = rig.left;
  rig.body_from_right = Rigid3d(Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.0});
  rig.already_rectified = true;
  const auto rectifier = Rectifier::Create(rig, SensorKind::kStereo);
  ASSERT_TRUE(rectifier) << rectifier.error().message;
  const cv::Mat image(48, 64, CV_8UC1, cv::Scalar(7));
  EXPECT_EQ(rectifier->RectifyLeft(image).data, image.data);
  EXPECT_EQ(rectifier->RectifyRight(image).data, image.data);
  EXPECT_EQ(rectifier->camera(), (IdealCamera{64, 48, 50, 51, 30, 25, 0.5}));
}

TEST(Rectifier, AWideLensIsCroppedToWhatAPinholeHolds) {
  CameraRig rig;
  rig.left = {.kind = LensKind::kEquidistant,
              .width = 512,
              .height = 512,
              .focal_x = 190.978,
              .focal_y = 190.973,
              .center_x = 254.931,
              .center_y = 256.897,
              .coefficients = {0.0034823894, 0.0007150348, -0.0020532361, 0.00020293673, 0.0}};
  const auto rectifier = Rectifier::Create(rig, SensorKind::kMonocular);
  ASSERT_TRUE(rectifier) << rectifier.error().message;
  EXPECT_NEAR(rectifier->camera().focal_x, 0.9 * 190.978, 1.0);
  const cv::Mat rectified = rectifier->RectifyLeft(cv::Mat(512, 512, CV_8UC1, cv::Scalar(200)));
  EXPECT_EQ(cv::countNonZero(rectified), 512 * 512);
}

TEST(Rectifier, RigsThatCannotBeRectifiedAreRefused) {
  const CameraRig good = testing::DroneRig();
  const auto message = [](const CameraRig& rig) {
    const auto rectifier = Rectifier::Create(rig, SensorKind::kStereo);
    return rectifier ? std::string("accepted") : rectifier.error().message;
  };
  CameraRig rig = good;
  rig.right.reset();
  EXPECT_THAT(message(rig), ::testing::HasSubstr("only one camera"));
  rig = good;
  std::swap(rig.body_from_left, rig.body_from_right);
  EXPECT_THAT(message(rig), ::testing::HasSubstr("not to the right"));
  rig = good;
  rig.body_from_right = rig.body_from_left;
  EXPECT_THAT(message(rig), ::testing::HasSubstr("same place"));
  rig = good;
  rig.right->width = 640;
  EXPECT_THAT(message(rig), ::testing::HasSubstr("different sizes"));
}

}  // namespace
}  // namespace pangaea
