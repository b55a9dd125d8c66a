#include "agent/tracking/patch_alignment.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/agent/tracking/textured_plane.h"

namespace pangaea {
namespace {

constexpr KeyframeId kKeyframe{1, 1};

Rigid3d Pose(double x, double y, double z, double roll_degrees) {
  const double angle = roll_degrees * std::numbers::pi / 180.0;
  return Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())), {x, y, z});
}

ImagePyramid PyramidOf(const cv::Mat& image) {
  ImagePyramid pyramid;
  BuildImagePyramid(image, 4, pyramid);
  return pyramid;
}

struct Outcome {
  int tried = 0;
  int found = 0;
  double worst = 0.0;  // pixels
};

// Templates cut at random places of one view, looked for in another from a prediction that is off by `offset`.
Outcome AlignAcross(const Rigid3d& view, const Rigid3d& other, double offset, bool coarse, double gain = 1.0) {
  const TexturedPlane plane(2.0, 7);
  const IdealCamera camera = SmallCamera();
  const ImagePyramid first = PyramidOf(plane.Render(camera, view));
  cv::Mat second_image = plane.Render(camera, other);
  second_image.convertTo(second_image, CV_8UC1, gain, 12.0 * (1.0 - gain));
  const ImagePyramid second = PyramidOf(second_image);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> column(70.0, 250.0);
  std::uniform_real_distribution<double> row(70.0, 170.0);
  std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi);
  Outcome outcome;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector2d pixel(column(random), row(random));
    const double direction = angle(random);
    const auto patch = CutTemplate(first, kKeyframe, pixel, 0);
    const Eigen::Vector3d point = plane.PointAt(camera, view, pixel.x(), pixel.y());
    const Eigen::Vector2d truth = camera.Project(other * point);
    const auto affine = CurrentFromTemplate(camera, other * view.Inverse(), view * point);
    if (!patch || !affine || !camera.Contains(truth, 30.0)) continue;
    ++outcome.tried;
    const Eigen::Vector2d predicted = truth + offset * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    const auto aligned = AlignPatch(second, *patch, *affine, predicted, coarse, {});
    if (!aligned) continue;
    ++outcome.found;
    outcome.worst = std::max(outcome.worst, (aligned->pixel - truth).norm());
  }
  return outcome;
}

TEST(PatchAlignment, FindsShiftedPatchesToAFractionOfAPixel) {
  const Outcome outcome = AlignAcross(Pose(0, 0, 0, 0), Pose(0.0312, -0.0177, 0, 0), 1.5, false);
  ASSERT_GT(outcome.tried, 30);
  EXPECT_GE(outcome.found, outcome.tried * 8 / 10);
  EXPECT_LT(outcome.worst, 0.15);
}

TEST(PatchAlignment, FollowsTurnAndScaleThroughTheAffineMap) {
  const Outcome outcome = AlignAcross(Pose(0, 0, 0, 0), Pose(0.02, 0.01, -0.5, 25.0), 1.0, false);
  ASSERT_GT(outcome.tried, 20);
  EXPECT_GE(outcome.found, outcome.tried * 5 / 10);
  EXPECT_LT(outcome.worst, 0.25);
}

TEST(PatchAlignment, ACoarseStartFindsWhatAFineOneMisses) {
  const Outcome fine = AlignAcross(Pose(0, 0, 0, 0), Pose(0.03, 0, 0, 0), 5.0, false);
  const Outcome coarse = AlignAcross(Pose(0, 0, 0, 0), Pose(0.03, 0, 0, 0), 5.0, true);
  EXPECT_GT(coarse.found, fine.found);
  EXPECT_GE(coarse.found, coarse.tried / 2);
}

TEST(PatchAlignment, IgnoresTheBrightnessOfTheImage) {
  const Outcome outcome = AlignAcross(Pose(0, 0, 0, 0), Pose(0.02, 0.01, 0, 0), 1.0, false, 0.6);
  EXPECT_GE(outcome.found, outcome.tried * 8 / 10);
  EXPECT_LT(outcome.worst, 0.25);
}

TEST(PatchAlignment, RefusesADifferentPlace) {
  const IdealCamera camera = SmallCamera();
  const ImagePyramid first = PyramidOf(TexturedPlane(2.0, 7).Render(camera, Rigid3d()));
  const ImagePyramid second = PyramidOf(TexturedPlane(2.0, 8).Render(camera, Rigid3d()));
  int found = 0;
  int tried = 0;
  for (double u = 60.0; u < 260.0; u += 20.0) {
    for (double v = 60.0; v < 180.0; v += 20.0) {
      const auto patch = CutTemplate(first, kKeyframe, {u, v}, 0);
      ASSERT_TRUE(patch);
      ++tried;
      found += AlignPatch(second, *patch, Eigen::Matrix2d::Identity(), {u, v}, true, {}).has_value() ? 1 : 0;
    }
  }
  EXPECT_LT(found, tried / 10);
}

TEST(PatchAlignment, RefusesAPatchWithoutTexture) {
  const cv::Mat grey(240, 320, CV_8UC1, cv::Scalar(128));
  const ImagePyramid image = PyramidOf(grey);
  const auto patch = CutTemplate(image, kKeyframe, {160.0, 120.0}, 0);
  ASSERT_TRUE(patch);
  EXPECT_FALSE(AlignPatch(image, *patch, Eigen::Matrix2d::Identity(), {160.0, 120.0}, true, {}));
}

TEST(PatchAlignment, SurvivesPredictionsOutsideOfTheImageAndNonsense) {
  const ImagePyramid image = PyramidOf(TexturedPlane(2.0, 7).Render(SmallCamera(), Rigid3d()));
  const auto patch = CutTemplate(image, kKeyframe, {160.0, 120.0}, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Matrix2d identity = Eigen::Matrix2d::Identity();
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(-50.0, 10.0), Eigen::Vector2d(1e9, 1e9),
                                       Eigen::Vector2d(319.0, 239.0), Eigen::Vector2d(nan, 3.0)}) {
    EXPECT_FALSE(AlignPatch(image, *patch, identity, pixel, true, {}));
  }
  EXPECT_FALSE(AlignPatch(image, *patch, Eigen::Matrix2d::Constant(nan), {160.0, 120.0}, true, {}));
  EXPECT_FALSE(CutTemplate(image, kKeyframe, {3.0, 120.0}, 0));
  EXPECT_FALSE(CutTemplate(image, kKeyframe, {nan, 120.0}, 0));
}

}  // namespace
}  // namespace pangaea
