#include "agent/tracking/patch_search.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/agent/tracking/textured_plane.h"

namespace pangaea {
namespace {

constexpr double kDepth = 2.0;
constexpr KeyframeId kKeyframe{1, 1};

ImagePyramid PyramidOf(const cv::Mat& image) {
  ImagePyramid pyramid;
  BuildImagePyramid(image, 4, pyramid);
  return pyramid;
}

// The corners that a camera at the map's origin sees on a wall, with their templates, and the image of another camera.
// The landmarks' points lie `beside` them (pixels of the first camera), all to the same side.
class PatchSearchTest : public testing::Test {
 protected:
  void MapCorners(const Eigen::Vector2d& beside) {
    const cv::Mat image = wall_.Render(camera_, Rigid3d());
    const ImagePyramid pyramid = PyramidOf(image);
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(image, corners, 150, 0.05, 8.0);
    local_map_ = {};
    local_map_.view_poses = {Rigid3d()};
    for (const cv::Point2f& corner : corners) {
      const Eigen::Vector2d pixel(corner.x, corner.y);
      const LandmarkId id{1, static_cast<std::uint32_t>(local_map_.landmarks.size() + 1)};
      const auto patch = CutTemplate(pyramid, kKeyframe, pixel, 0);
      if (!patch) continue;
      templates_.Add(id, *patch);
      LocalLandmark& landmark = local_map_.landmarks.emplace_back();
      landmark.id = id;
      landmark.point_in_map = kDepth * camera_.Unproject(pixel - beside);
      landmark.observers = {4, Eigen::Vector3d::Zero(), 1.0};
      landmark.view_count = 1;
      landmark.views[0] = {&templates_.Find(id)[0], 0};
    }
  }

  // From a prediction that is off by a centimetre along each axis, and by a quarter of a degree.
  std::optional<LocatedFrame> Locate() {
    const ImagePyramid image = PyramidOf(wall_.Render(camera_, truth_));
    Vector6d error;
    error << 0.01, -0.01, 0.01, 0.004, -0.004, 0.004;
    return LocateFrame(image, camera_, Rigid3d::Exp(error) * truth_, local_map_, {});
  }

  static double Distance(const Rigid3d& a, const Rigid3d& b) {
    return (a.Inverse().translation() - b.Inverse().translation()).norm();
  }

  const IdealCamera camera_ = SmallCamera();
  const TexturedPlane wall_{kDepth, 7};
  const Rigid3d truth_{Eigen::Quaterniond(Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitZ())), {0.03, -0.02, 0.05}};
  TemplateStore templates_{1000};
  LocalMap local_map_;
};

TEST_F(PatchSearchTest, FindsWhereTheCameraIs) {
  MapCorners(Eigen::Vector2d::Zero());
  const auto located = Locate();
  ASSERT_TRUE(located);
  EXPECT_GE(located->pose.inliers, 60);
  EXPECT_LT(Distance(located->pose.camera_from_map, truth_), 0.0015);
}

TEST_F(PatchSearchTest, CornersThatLieBesideTheirPointsAreTakenForWhereTheyWereSeen) {
  const Eigen::Vector2d beside(1.0, -0.5);
  MapCorners(beside);
  const auto pulled = Locate();
  ASSERT_TRUE(pulled);
  EXPECT_GT(Distance(pulled->pose.camera_from_map, truth_), 0.006) << "the camera follows the points";
  for (LocalLandmark& landmark : local_map_.landmarks) landmark.latest_sighting = Sighting{0, beside};
  const auto located = Locate();
  ASSERT_TRUE(located);
  EXPECT_LT(Distance(located->pose.camera_from_map, truth_), 0.0015);
  // What the frame saw is the corners, and not the points: a keyframe made of it hands them on.
  double worst = 0.0;
  for (const LandmarkMatch& match : located->matches) {
    const LandmarkView& view = local_map_.landmarks[static_cast<std::size_t>(match.landmark)].views[0];
    const Eigen::Vector3d corner = kDepth * camera_.Unproject(view.patch->pixel);
    worst = std::max(worst, (camera_.Project(truth_ * corner) - match.pixel).norm());
  }
  EXPECT_LT(worst, 1.0);
}

TEST_F(PatchSearchTest, WhatWasSeenFromTooFarToTheSideSaysNothing) {
  MapCorners(Eigen::Vector2d::Zero());
  // A camera to the left that looks along the wall: it sees every corner more than 60 degrees from the side.
  const Rigid3d aside(Eigen::Quaterniond(Eigen::AngleAxisd(-1.4, Eigen::Vector3d::UnitY())), Eigen::Vector3d::Zero());
  local_map_.view_poses.push_back(aside * Rigid3d({1, 0, 0, 0}, {9.0, 0.0, 0.0}));
  for (LocalLandmark& landmark : local_map_.landmarks) landmark.latest_sighting = Sighting{1, {2.0, 2.0}};
  const auto located = Locate();
  ASSERT_TRUE(located);
  EXPECT_LT(Distance(located->pose.camera_from_map, truth_), 0.0015);
}

}  // namespace
}  // namespace pangaea
