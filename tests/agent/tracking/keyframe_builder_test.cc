#include "agent/tracking/keyframe_builder.h"

#include <gtest/gtest.h>

#include "tests/agent/tracking/textured_plane.h"

namespace pangaea {
namespace {

constexpr double kDepth = 3.0;

class KeyframeBuilderTest : public ::testing::Test {
 protected:
  // A camera at the origin of the map before the wall, tracked on three of its points.
  KeyframeBuilderTest() {
    located.pose.camera_from_map = Rigid3d();
    for (std::uint32_t i = 0; i < 3; ++i) {
      const Eigen::Vector2d pixel(80.0 + 60.0 * i, 100.0);
      local_map.landmarks.emplace_back().id = {1, 10 + i};
      local_map.landmarks.back().point_in_map = wall.PointAt(camera, Rigid3d(), pixel.x(), pixel.y());
      located.matches.push_back({.landmark = static_cast<int>(i), .pixel = pixel, .octave = 1});
    }
    raw.id = {1, 2};
    raw.map = {1, 1};
    raw.stamp_ns = 5;
    raw.left = wall.Render(camera, Rigid3d());
    raw.reference = {1, 1};
    raw.camera_from_reference = Rigid3d(Eigen::Quaterniond::Identity(), {0.1, 0.2, 0.3});
    raw.reference_scale = {2.0};
    raw.arrival = {raw.reference, raw.camera_from_reference, 2.0, 4};
    TakeTracked(located, local_map, raw);
  }

  cv::Mat Right() const {
    return wall.Render(camera, Rigid3d(Eigen::Quaterniond::Identity(), {-camera.baseline, 0.0, 0.0}));
  }

  const IdealCamera camera = SmallCamera();
  const TexturedPlane wall{kDepth, 1};
  LocalMap local_map;
  LocatedFrame located;
  RawKeyframe raw;
  KeyframeBuilder builder{camera, OrbOptions{.features = 200}, {}};
  NoStageRecorder stages;
};

TEST_F(KeyframeBuilderTest, TrackedLandmarksAreTheFirstKeypointsAndNewCornersHaveNone) {
  const KeyframeCandidate candidate = builder.Build(raw, stages);
  ASSERT_GT(candidate.data->features.keypoints.size(), 50U);
  ASSERT_EQ(candidate.landmarks.size(), candidate.data->features.keypoints.size());
  for (std::uint32_t i = 0; i < candidate.landmarks.size(); ++i) {
    const LandmarkId tracked = i < 3 ? LandmarkId{1, 10 + i} : LandmarkId{};
    EXPECT_EQ(candidate.landmarks[i], tracked);
  }
  EXPECT_EQ(candidate.data->features.keypoints[1].u, 140.0F);
  EXPECT_EQ(candidate.data->features.keypoints[1].octave, 1);
}

TEST_F(KeyframeBuilderTest, WhatTrackingKnowsGoesIntoTheCandidate) {
  const KeyframeCandidate candidate = builder.Build(raw, stages);
  EXPECT_EQ(candidate.id, raw.id);
  EXPECT_EQ(candidate.map, raw.map);
  EXPECT_EQ(candidate.data->stamp_ns, 5);
  EXPECT_EQ(candidate.reference, raw.reference);
  EXPECT_EQ(candidate.camera_from_reference.translation(), raw.camera_from_reference.translation());
  EXPECT_EQ(candidate.reference_scale.value, 2.0);
  EXPECT_EQ(candidate.data->arrival.reference, raw.reference);
  EXPECT_EQ(candidate.data->arrival.since_ns, 4);
}

TEST_F(KeyframeBuilderTest, DepthIsThatOfTheWall) {
  int asked = 0;
  raw.right = [&](StageRecorder&) {
    ++asked;
    return Right();
  };
  const KeyframeCandidate candidate = builder.Build(raw, stages);
  EXPECT_EQ(asked, 1);
  int with_depth = 0;
  for (const Keypoint& keypoint : candidate.data->features.keypoints) {
    if (!keypoint.has_depth()) continue;
    ++with_depth;
    EXPECT_NEAR(camera.focal_x * camera.baseline / (keypoint.u - keypoint.u_right), kDepth, 0.2);
  }
  EXPECT_GT(with_depth, 100);
}

TEST_F(KeyframeBuilderTest, WithoutARightImageThereIsNoDepth) {
  for (const RightImage& right : {RightImage(), RightImage([](StageRecorder&) { return cv::Mat(); })}) {
    raw.right = right;
    const KeyframeCandidate candidate = builder.Build(raw, stages);
    ASSERT_FALSE(candidate.data->features.keypoints.empty());
    for (const Keypoint& keypoint : candidate.data->features.keypoints) EXPECT_FALSE(keypoint.has_depth());
  }
}

TEST_F(KeyframeBuilderTest, WhatWasTrackedLaterTakesThePlaceOfWhatWasTrackedBefore) {
  located.matches.resize(1);
  TakeTracked(located, local_map, raw);
  EXPECT_EQ(raw.tracked.size(), 1U);
  ASSERT_EQ(raw.depths.size(), 1U);
  EXPECT_NEAR(raw.depths[0], kDepth, 1e-6);
  EXPECT_EQ(raw.landmarks, std::vector<LandmarkId>({{1, 10}}));
}

}  // namespace
}  // namespace pangaea
