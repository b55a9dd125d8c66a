#include "agent/tracking/local_map.h"

#include <gtest/gtest.h>

#include "tests/agent/tracking/keyframe_chain.h"

namespace pangaea {
namespace {

constexpr SessionId kOther = 9;
constexpr LandmarkId kLandmark{kSession, 1};
const Eigen::Vector3d kPoint{1.0, 0.5, 4.0};  // in the map

// A map whose keyframes, at x = 0, 1, 2, … of the session given, see one landmark so many pixels beside its point.
struct Look {
  SessionId session = kSession;
  Eigen::Vector2d beside = Eigen::Vector2d::Zero();
  std::uint8_t octave = 0;
};
Atlas Seen(const std::vector<Look>& looks) {
  Atlas atlas;
  std::vector<Observation> observations;
  KeyframeId parent;
  for (const Look& look : looks) {
    const KeyframeId id{look.session, static_cast<std::uint32_t>(observations.size() + 1)};
    const double x = static_cast<double>(observations.size());
    auto data = std::make_shared<KeyframeData>();
    data->camera = {640, 480, 400.0, 400.0, 320.0, 240.0, 0.1};
    const Eigen::Vector2d pixel = data->camera.Project(At(x) * kPoint) + look.beside;
    data->features.keypoints = {{QuantizePixel(pixel.x()), QuantizePixel(pixel.y()), -1.0F, look.octave}};
    data->features.descriptors.resize(1);
    EXPECT_TRUE(Apply(AddKeyframe{id, kMap, parent, parent.valid() ? At(1.0) : Rigid3d(), data}, atlas));
    observations.push_back({id, 0});
    parent = id;
  }
  EXPECT_TRUE(Apply(AddLandmark{kLandmark, observations[0].keyframe, 0, kPoint}, atlas));
  for (std::size_t i = 1; i < observations.size(); ++i) {
    EXPECT_TRUE(Apply(AddObservation{kLandmark, observations[i].keyframe, 0}, atlas));
  }
  return atlas;
}

TemplateStore TemplateOf(KeyframeId keyframe) {
  TemplateStore templates(10);
  PatchTemplate view;
  view.keyframe = keyframe;
  templates.Add(kLandmark, view);
  return templates;
}

std::optional<Sighting> LatestSighting(const Atlas& atlas, const TemplateStore& templates, LocalMap& local_map) {
  local_map = CollectLocalMap(atlas, {kSession, 1}, templates, {}, {});
  EXPECT_EQ(local_map.landmarks.size(), 1U);
  return local_map.landmarks.at(0).latest_sighting;
}

TEST(LocalMap, KnowsHowFarBesideItsPointTheNewestKeyframeOfTheSessionSawALandmark) {
  const Atlas atlas = Seen({{kSession, {0.5, 0.0}}, {kSession, {-0.25, 0.75}}, {kOther, {0.0, -1.0}}});
  LocalMap local_map;
  const auto sighting = LatestSighting(atlas, TemplateOf({kSession, 1}), local_map);
  ASSERT_TRUE(sighting);
  EXPECT_LT((sighting->beside - Eigen::Vector2d(-0.25, 0.75)).norm(), 1e-6);
  EXPECT_LT((local_map.view_poses.at(sighting->pose) * At(1.0).Inverse()).Log().norm(), 1e-12);
}

TEST(LocalMap, WhatWasSeenTooFarBesideMayHaveBeenSomethingElse) {
  LocalMap local_map;
  EXPECT_TRUE(LatestSighting(Seen({{}, {kSession, {2.4, 0.0}}}), TemplateOf({kSession, 1}), local_map));
  EXPECT_FALSE(LatestSighting(Seen({{}, {kSession, {2.5, 0.0}}}), TemplateOf({kSession, 1}), local_map));
}

TEST(LocalMap, TheBoundGrowsWithTheOctave) {
  constexpr std::uint8_t kOctave = 4;  // a little more than two pixels each
  LocalMap local_map;
  EXPECT_TRUE(LatestSighting(Seen({{}, {kSession, {5.0, 0.0}, kOctave}}), TemplateOf({kSession, 1}), local_map));
  EXPECT_FALSE(LatestSighting(Seen({{}, {kSession, {5.2, 0.0}, kOctave}}), TemplateOf({kSession, 1}), local_map));
}

TEST(LocalMap, WhereTheNewestKeyframeIsCulledTheOneBeforeSawItLast) {
  Atlas atlas = Seen({{kSession, {0.5, 0.0}}, {kSession, {-0.25, 0.75}}});
  ASSERT_TRUE(Apply(RemoveKeyframe{{kSession, 2}}, atlas));
  LocalMap local_map;
  const auto sighting = LatestSighting(atlas, TemplateOf({kSession, 2}), local_map);
  ASSERT_TRUE(sighting);
  EXPECT_LT((sighting->beside - Eigen::Vector2d(0.5, 0.0)).norm(), 1e-6);
  EXPECT_LT(local_map.view_poses.at(sighting->pose).Log().norm(), 1e-12);
}

TEST(LocalMap, WhatTheSessionOfItsTemplatesDoesNotObserveWasNotSeen) {
  Atlas atlas = Seen({{kSession}, {kSession}});
  Extend({kOther, 3}, {kSession, 2}, atlas);
  LocalMap local_map;
  EXPECT_FALSE(LatestSighting(atlas, TemplateOf({kOther, 3}), local_map));
  EXPECT_EQ(local_map.landmarks.at(0).view_count, 1);
  EXPECT_FALSE(LatestSighting(atlas, TemplateStore(10), local_map)) << "it cannot be followed";
}

}  // namespace
}  // namespace pangaea
