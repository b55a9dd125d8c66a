#include "agent/tracking/patch_alignment.h"

#include <gtest/gtest.h>

#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

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

const std::vector<TexturedPlane>& Walls() {
  static const std::vector<TexturedPlane> walls = [] {
    std::vector<TexturedPlane> all;
    for (std::uint64_t seed = 7; seed < 13; ++seed) all.emplace_back(2.0, seed);
    return all;
  }();
  return walls;
}

struct Outcome {
  int tried = 0;
  int found = 0;
  double worst = 0.0;  // pixels

  double share() const { return static_cast<double>(found) / tried; }
};

// Corners in the middle of a view: where tracking has landmarks. Elsewhere a window may hold too little texture.
std::vector<cv::Point2f> CornersOf(const cv::Mat& image) {
  cv::Mat middle(image.size(), CV_8UC1, cv::Scalar(0));
  middle(cv::Rect(70, 70, 180, 100)).setTo(255);
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(image, corners, 25, 0.15, 10.0, middle, 8);
  return corners;
}

// Templates cut at the corners of one view, looked for in another from a prediction that is off by `offset`, on several
// walls.
Outcome AlignAcross(const Rigid3d& view, const Rigid3d& other, double offset, bool coarse, double gain = 1.0) {
  const IdealCamera camera = SmallCamera();
  Outcome outcome;
  for (const TexturedPlane& plane : Walls()) {
    const cv::Mat first_image = plane.Render(camera, view);
    const ImagePyramid first = PyramidOf(first_image);
    cv::Mat second_image = plane.Render(camera, other);
    second_image.convertTo(second_image, CV_8UC1, gain, 12.0 * (1.0 - gain));
    const ImagePyramid second = PyramidOf(second_image);
    for (const cv::Point2f& corner : CornersOf(first_image)) {
      const Eigen::Vector2d pixel(corner.x, corner.y);
      const auto patch = CutTemplate(first, kKeyframe, pixel, 0);
      const Eigen::Vector3d point = plane.PointAt(camera, view, pixel.x(), pixel.y());
      const Eigen::Vector2d truth = camera.Project(other * point);
      const auto affine = CurrentFromTemplate(camera, other * view.Inverse(), view * point);
      if (!patch || !affine || !camera.Contains(truth, 30.0)) continue;
      const double direction = 0.1 * ++outcome.tried;  // every way
      const Eigen::Vector2d predicted = truth + offset * Eigen::Vector2d(std::cos(direction), std::sin(direction));
      const auto aligned = AlignPatch(second, *patch, *affine, predicted, coarse, {});
      if (!aligned) continue;
      ++outcome.found;
      outcome.worst = std::max(outcome.worst, (aligned->pixel - truth).norm());
    }
  }
  return outcome;
}

TEST(PatchAlignment, FindsShiftedPatchesToAFractionOfAPixel) {
  const Outcome outcome = AlignAcross(Pose(0, 0, 0, 0), Pose(0.0312, -0.0177, 0, 0), 1.5, false);
  ASSERT_GT(outcome.tried, 100);
  EXPECT_GT(outcome.share(), 0.9);
  EXPECT_LT(outcome.worst, 0.15);
}

TEST(PatchAlignment, FollowsTurnAndScaleThroughTheAffineMap) {
  const Outcome outcome = AlignAcross(Pose(0, 0, 0, 0), Pose(0.02, 0.01, -0.5, 25.0), 1.0, false);
  ASSERT_GT(outcome.tried, 100);
  // Magnified by a third, the window sees less of a corner: some hold too little texture then, and are refused.
  EXPECT_GT(outcome.share(), 0.7);
  EXPECT_LT(outcome.worst, 0.3);
}

TEST(PatchAlignment, ACoarseStartFindsWhatAFineOneMisses) {
  const Outcome fine = AlignAcross(Pose(0, 0, 0, 0), Pose(0.03, 0, 0, 0), 5.0, false);
  const Outcome coarse = AlignAcross(Pose(0, 0, 0, 0), Pose(0.03, 0, 0, 0), 5.0, true);
  EXPECT_GT(coarse.found, fine.found);
  EXPECT_GT(coarse.share(), 0.9);
  EXPECT_LT(coarse.worst, 0.15);
}

TEST(PatchAlignment, IgnoresTheBrightnessOfTheImage) {
  const Outcome outcome = AlignAcross(Pose(0, 0, 0, 0), Pose(0.02, 0.01, 0, 0), 1.0, false, 0.6);
  EXPECT_GT(outcome.share(), 0.9);
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
