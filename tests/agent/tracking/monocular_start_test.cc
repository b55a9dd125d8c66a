#include "agent/tracking/monocular_start.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "tests/agent/tracking/textured_plane.h"

namespace pangaea {
namespace {

constexpr std::int64_t kFrameTime = 50'000'000;

IdealCamera MonocularCamera() {
  IdealCamera camera = SmallCamera();
  camera.baseline = 0.0;
  return camera;
}

// A near wall on the left and a far one on the right.
class TwoWalls {
 public:
  explicit TwoWalls(std::uint64_t seed) : near_(3.0, seed), far_(5.0, seed + 1) {}

  cv::Mat Render(const Rigid3d& camera_from_map) const {
    const IdealCamera camera = MonocularCamera();
    cv::Mat image = far_.Render(camera, camera_from_map);
    const cv::Mat near = near_.Render(camera, camera_from_map);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        if (IsNear(camera_from_map, u, v)) image.at<std::uint8_t>(v, u) = near.at<std::uint8_t>(v, u);
      }
    }
    return image;
  }
  double DepthAt(double u, double v) const { return IsNear(Rigid3d(), u, v) ? 3.0 : 5.0; }

 private:
  bool IsNear(const Rigid3d& camera_from_map, double u, double v) const {
    return near_.PointAt(MonocularCamera(), camera_from_map, u, v).x() < 0.1;
  }

  TexturedPlane near_;
  TexturedPlane far_;
};

// Where the camera is at each frame; the first one is the map's origin.
using Way = std::function<Rigid3d(int)>;

Rigid3d Sideways(int frame) { return Rigid3d(Eigen::Quaterniond::Identity(), {-0.015 * frame, 0.0, 0.0}); }
Rigid3d Standing(int) { return {}; }
Rigid3d Turning(int frame) {
  Vector6d twist = Vector6d::Zero();
  twist(4) = 0.006 * frame;
  return Rigid3d::Exp(twist);
}

class Starter {
 public:
  explicit Starter(MonocularStartOptions options = {}) : start_(MonocularCamera(), options, {}, 7) {}

  std::optional<MonocularOpening> Give(const cv::Mat& image, std::int64_t stamp_ns) {
    BuildImagePyramid(image, kMaxPyramidLevels, pyramid_);
    if (start_.wants_first_frame()) {
      start_.Begin(stamp_ns, pyramid_, extractor_.Extract(image));
      return std::nullopt;
    }
    return start_.Follow(stamp_ns, pyramid_);
  }
  std::optional<MonocularOpening> Fly(const TwoWalls& world, const Way& way, int frames) {
    for (int i = 0; i < frames; ++i) {
      if (auto opening = Give(world.Render(way(i)), kFrameTime * i)) return opening;
    }
    return std::nullopt;
  }
  bool wants_first_frame() const { return start_.wants_first_frame(); }

 private:
  OrbExtractor extractor_;
  MonocularStart start_;
  ImagePyramid pyramid_;
};

TEST(MonocularStart, ACameraThatMovesBeginsAMapWithTheTrueMotionAndDepths) {
  const TwoWalls world(1);
  const auto opening = Starter().Fly(world, Sideways, 30);
  ASSERT_TRUE(opening);
  EXPECT_EQ(opening->first_stamp_ns, 0);
  const Eigen::Vector3d direction = opening->second_from_first.translation().normalized();
  EXPECT_LT((direction - Eigen::Vector3d(-1.0, 0.0, 0.0)).norm(), 0.05);
  EXPECT_LT(LogSo3(opening->second_from_first.rotation()).norm(), 0.01);
  ASSERT_GE(opening->points.size(), 80U);
  ASSERT_EQ(opening->second_points.size(), opening->points.size());
  std::vector<double> depths;
  std::vector<double> scales;
  for (const OpeningPoint& point : opening->points) {
    const Keypoint& keypoint = opening->first_features.keypoints[point.first_keypoint];
    depths.push_back(point.point_in_first.z());
    scales.push_back(point.point_in_first.z() / world.DepthAt(keypoint.u, keypoint.v));
  }
  std::ranges::sort(depths);
  EXPECT_NEAR(depths[depths.size() / 2], MonocularStartOptions{}.median_depth, 1e-9);
  std::ranges::sort(scales);
  const std::size_t tenth = scales.size() / 10;
  EXPECT_LT(scales[scales.size() - 1 - tenth] / scales[tenth], 1.15) << "one scale for near and far points";
}

TEST(MonocularStart, FramesBetweenGetPosesThatGoTheSameWay) {
  const auto opening = Starter().Fly(TwoWalls(2), Sideways, 30);
  ASSERT_TRUE(opening);
  ASSERT_GE(opening->between.size(), 5U);
  const double whole = opening->second_from_first.Inverse().translation().x();
  const auto frames = static_cast<double>(opening->between.size() + 1);
  for (std::size_t i = 0; i < opening->between.size(); ++i) {
    EXPECT_EQ(opening->between[i].stamp_ns, kFrameTime * static_cast<std::int64_t>(i + 1));
    const double way = opening->between[i].reference_from_frame.translation().x();
    EXPECT_NEAR(way / whole, static_cast<double>(i + 1) / frames, 0.08) << "frame " << i + 1;
  }
}

TEST(MonocularStart, ACameraThatStandsOrOnlyTurnsBeginsNoMap) {
  for (const Way& way : {Way(Standing), Way(Turning)}) {
    EXPECT_FALSE(Starter().Fly(TwoWalls(3), way, 25));
  }
}

TEST(MonocularStart, AnotherFirstFrameIsChosenWhenTheSceneIsGone) {
  Starter starter;
  EXPECT_FALSE(starter.Fly(TwoWalls(4), Standing, 3));
  EXPECT_FALSE(starter.wants_first_frame());
  EXPECT_FALSE(starter.Give(TwoWalls(50).Render({}), 3 * kFrameTime));
  EXPECT_TRUE(starter.wants_first_frame());
  const auto opening = starter.Fly(TwoWalls(60), Sideways, 30);
  ASSERT_TRUE(opening);
}

TEST(MonocularStart, AnImageWithoutCornersIsNoFirstFrame) {
  Starter starter;
  EXPECT_FALSE(starter.Give(cv::Mat(240, 320, CV_8UC1, cv::Scalar(90)), 0));
  EXPECT_TRUE(starter.wants_first_frame());
}

TEST(MonocularStart, AMomentaryReconstructionIsNotEnough) {
  MonocularStartOptions patient;
  patient.confirmations = 100;
  EXPECT_FALSE(Starter(patient).Fly(TwoWalls(5), Sideways, 25));
  MonocularStartOptions hasty;
  hasty.confirmations = 1;
  EXPECT_TRUE(Starter(hasty).Fly(TwoWalls(5), Sideways, 25));
}

TEST(MonocularStartOptions, ANonsenseValueIsNamed) {
  EXPECT_TRUE(MonocularStartOptions{}.Check());
  MonocularStartOptions options;
  options.confirmations = 0;
  const auto status = options.Check();
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("confirmations"), std::string::npos);
}

}  // namespace
}  // namespace pangaea
