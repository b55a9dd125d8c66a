#include "agent/tracking/keyframe_decision.h"

#include <gtest/gtest.h>

#include "agent/tracking/template_store.h"

namespace pangaea {
namespace {

constexpr double kNear = 0.3;
constexpr double kOnTheWay = 0.7;
constexpr double kFar = 1.2;

TEST(KeyframeDecision, AStillCameraNeverNeedsAnother) {
  KeyframeDecision decision({});
  for (int frame = 0; frame < 1000; ++frame) EXPECT_FALSE(decision.IsDue({200, 60, 3.0}, kNear, false));
}

TEST(KeyframeDecision, IsDueWhenTheViewLeavesWhatWasCovered) {
  KeyframeDecision decision({});
  EXPECT_FALSE(decision.IsDue({200, 60, 3.0}, kOnTheWay, false));
  EXPECT_FALSE(decision.IsDue({200, 55, 3.0}, kOnTheWay, false));
  EXPECT_TRUE(decision.IsDue({200, 40, 3.0}, kOnTheWay, false));
}

TEST(KeyframeDecision, WhereAKeyframeSeesNearlyTheSameOnlyUrgencyCallsForAnother) {
  KeyframeDecision decision({});
  EXPECT_FALSE(decision.IsDue({200, 60, 3.0}, kNear, false));
  EXPECT_FALSE(decision.IsDue({110, 30, 3.0}, kNear, false));
  EXPECT_FALSE(decision.IsDue({110, 30, 3.0}, kNear, false));
  EXPECT_TRUE(decision.IsDue({50, 20, 3.0}, kNear, false));
}

TEST(KeyframeDecision, IsDueFarFromAllOthers) {
  KeyframeDecision decision({});
  EXPECT_FALSE(decision.IsDue({200, 60, 3.0}, kFar, false));  // too soon after the latest
  EXPECT_TRUE(decision.IsDue({200, 60, 3.0}, kFar, false));
  decision.Restart();
  EXPECT_FALSE(decision.IsDue({200, 60, 3.0}, kFar, false));
}

TEST(KeyframeDecision, WaitsForMappingUnlessTrackingGetsThin) {
  KeyframeDecision decision({});
  EXPECT_FALSE(decision.IsDue({200, 60, 3.0}, kNear, true));
  EXPECT_FALSE(decision.IsDue({110, 40, 3.0}, kFar, true));
  EXPECT_TRUE(decision.IsDue({50, 20, 3.0}, kFar, true));
}

TEST(KeyframeDecision, ViewDistanceTakesTheLargerOfShiftAndTurn) {
  KeyframeDecisionOptions options;
  options.max_relative_distance = 0.1;
  options.max_turn = 20.0;
  const Rigid3d shifted(Eigen::Quaterniond::Identity(), {0.2, 0.0, 0.0});
  EXPECT_NEAR(ViewDistance(Rigid3d(), shifted, 4.0, options), 0.5, 1e-9);
  const Rigid3d turned(Eigen::Quaterniond(Eigen::AngleAxisd(0.1745329, Eigen::Vector3d::UnitY())), {0.0, 0.0, 0.0});
  EXPECT_NEAR(ViewDistance(Rigid3d(), turned, 4.0, options), 0.5, 1e-4);
}

TEST(TemplateStore, KeepsTheFirstViewAndTheNewestOthers) {
  TemplateStore store(10);
  for (std::uint32_t i = 1; i <= 5; ++i) {
    PatchTemplate view;
    view.keyframe = {1, i};
    store.Add({1, 1}, view);
  }
  const auto views = store.Find({1, 1});
  ASSERT_EQ(views.size(), TemplateStore::kViewsPerLandmark);
  EXPECT_EQ(views[0].keyframe.counter, 1U);
  EXPECT_EQ(views[1].keyframe.counter, 4U);
  EXPECT_EQ(views[2].keyframe.counter, 5U);
}

TEST(TemplateStore, ForgetsTheOldestLandmarkWhenFull) {
  TemplateStore store(2);
  for (std::uint32_t i = 1; i <= 3; ++i) store.Add({1, i}, PatchTemplate{});
  EXPECT_EQ(store.size(), 2U);
  EXPECT_FALSE(store.Has({1, 1}));
  EXPECT_TRUE(store.Has({1, 3}));
  EXPECT_TRUE(store.Find({1, 1}).empty());
}

}  // namespace
}  // namespace pangaea
