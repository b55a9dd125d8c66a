#include "common/simulation/renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "common/simulation/recording.h"

namespace pangaea {
namespace {

constexpr int kTexels = 512;

std::shared_ptr<const Texture> Plain(std::uint8_t value) {
  return std::make_shared<const Texture>(4, 4, 1, std::vector<std::uint8_t>(16, value));
}

// Bright round spots on black, at multiples of an eighth of the side.
std::shared_ptr<const Texture> Spots() {
  constexpr double kRadius = 7.0;  // texels
  std::vector<std::uint8_t> texels(static_cast<std::size_t>(kTexels) * kTexels, 0);
  for (int y = 0; y < kTexels; ++y) {
    for (int x = 0; x < kTexels; ++x) {
      const double dx = std::remainder(x + 0.5, kTexels / 8.0);
      const double dy = std::remainder(y + 0.5, kTexels / 8.0);
      if (std::hypot(dx, dy) < kRadius)
        texels[static_cast<std::size_t>(y) * kTexels + static_cast<std::size_t>(x)] = 240;
    }
  }
  return std::make_shared<const Texture>(kTexels, kTexels, 7, texels);
}

// A wall of 4 x 4 m at `distance` before a camera at the origin, turned about the vertical.
Surface WallBefore(double distance, double turn, std::shared_ptr<const Texture> texture) {
  const Eigen::Vector3d along(4.0 * std::cos(turn), 0.0, 4.0 * std::sin(turn));
  const Eigen::Vector3d across(0.0, 4.0, 0.0);
  return {Eigen::Vector3d(0.0, 0.0, distance) - 0.5 * along - 0.5 * across, along, across, std::move(texture)};
}

// The brightness's centre of gravity around a pixel.
Eigen::Vector2d SpotAround(const cv::Mat& image, const Eigen::Vector2d& pixel, int radius) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0.0;
  const int column = static_cast<int>(std::lround(pixel.x()));
  const int row = static_cast<int>(std::lround(pixel.y()));
  for (int y = row - radius; y <= row + radius; ++y) {
    for (int x = column - radius; x <= column + radius; ++x) {
      const double value = image.at<float>(y, x);
      sum += value * Eigen::Vector2d(x, y);
      weight += value;
    }
  }
  return sum / weight;
}

class SpotsOnAWall : public testing::TestWithParam<double> {};

TEST_P(SpotsOnAWall, AppearWhereTheLensProjectsThem) {
  const CameraRig rig = SimulatedRig(SensorKind::kStereo);
  const double distance = 3.0;
  const std::vector<Surface> scene = {WallBefore(distance, GetParam(), Spots())};
  // From slightly aside and above, so that nothing is symmetric.
  const Rigid3d camera_from_world(Eigen::Quaterniond(Eigen::AngleAxisd(0.05, Eigen::Vector3d(1, 2, 3).normalized())),
                                  {0.13, -0.07, 0.2});
  for (const LensModel& lens : {rig.left, *rig.right}) {
    Renderer renderer(std::make_shared<const RayTable>(lens));
    cv::Mat image;
    renderer.Render(scene, camera_from_world, image);
    int seen = 0;
    for (int i = 1; i < 8; ++i) {
      for (int j = 1; j < 8; ++j) {
        const Eigen::Vector3d spot = scene[0].corner + i / 8.0 * scene[0].along + j / 8.0 * scene[0].across;
        const Eigen::Vector3d in_camera = camera_from_world * spot;
        const Eigen::Vector2d expected = lens.Project(in_camera);
        if (expected.x() < 20 || expected.y() < 20 || expected.x() > 731 || expected.y() > 459) continue;
        ++seen;
        EXPECT_LT((SpotAround(image, expected, 14) - expected).norm(), 0.1) << "spot " << i << " " << j;
      }
    }
    EXPECT_GT(seen, 20);
  }
}

INSTANTIATE_TEST_SUITE_P(Turns, SpotsOnAWall, testing::Values(0.0, 0.4, -0.6));

TEST(Renderer, TheNearerOfTwoSurfacesIsSeenWhateverTheirOrder) {
  const LensModel lens = SimulatedRig(SensorKind::kMonocular).left;
  Renderer renderer(std::make_shared<const RayTable>(lens));
  const Surface near_wall = WallBefore(2.0, 0.1, Plain(200));
  const Surface far_wall = WallBefore(2.5, -0.1, Plain(50));
  for (const auto& scene : {std::vector<Surface>{near_wall, far_wall}, std::vector<Surface>{far_wall, near_wall}}) {
    cv::Mat image;
    renderer.Render(scene, Rigid3d(), image);
    EXPECT_EQ(image.at<float>(240, 372), 200.0F);
  }
}

TEST(Renderer, ASurfaceIsNotSeenFromBehind) {
  Surface wall = WallBefore(2.0, 0.0, Plain(200));
  std::swap(wall.along, wall.across);
  Renderer renderer(std::make_shared<const RayTable>(SimulatedRig(SensorKind::kMonocular).left));
  cv::Mat image;
  renderer.Render({wall}, Rigid3d(), image);
  EXPECT_EQ(cv::Mat(image != 0.0F).size().area() - cv::Mat(image == 0.0F).size().area(), 0);
  for (int y = 0; y < image.rows; y += 20) EXPECT_EQ(image.at<float>(y, 376), 0.0F);
}

TEST(Renderer, AnEdgeIsSmoothToAFractionOfAPixel) {
  // A bright wall's left edge, seen by an ideal camera that moves in tenths of a pixel: the sum along a row must move
  // with it.
  LensModel lens = SimulatedRig(SensorKind::kMonocular).left;
  lens.coefficients = {};
  Renderer renderer(std::make_shared<const RayTable>(lens));
  const Surface wall = WallBefore(2.0, 0.0, Plain(200));
  const auto covered = [&](double pixels) {
    cv::Mat image;
    renderer.Render({wall}, Rigid3d(Eigen::Quaterniond::Identity(), {2.5 + 2.0 * pixels / lens.focal_x, 0.0, 0.0}),
                    image);
    double sum = 0.0;
    for (int x = 0; x < image.cols; ++x) sum += image.at<float>(240, x) / 200.0;
    return sum;
  };
  const double start = covered(0.0);
  ASSERT_GT(start, 50.0);
  ASSERT_LT(start, 700.0);
  for (double shift = 0.1; shift < 2.0; shift += 0.1) EXPECT_NEAR(start - covered(shift), shift, 0.13);
}

}  // namespace
}  // namespace pangaea
