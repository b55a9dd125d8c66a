#include "server/place_recognition/frame_lookup.h"

#include <gtest/gtest.h>

#include "tests/server/read_vocabulary.h"
#include "tests/server/surveyed_world.h"

namespace pangaea::testing {
namespace {

constexpr SessionId kMapper = 0xa;
constexpr SessionId kLost = 0xb;
constexpr int kCircle = 36;  // poses of a whole round

// What a camera shows that has been there in this world: a keyframe without its landmarks and without depth.
KeyframeData LookAround(SurveyedWorld& world, int place, bool stereo = true) {
  world.Fly(kLost, CirclePoses(place, place, kCircle), {});
  KeyframeData frame = *world.atlas.FindKeyframe(world.KeyframesOf(kLost).back())->data;
  for (Keypoint& keypoint : frame.features.keypoints) keypoint.u_right = -1.0F;
  if (!stereo) frame.camera.baseline = 0.0;
  return frame;
}

// The keyframes of the mapper alone.
InvertedIndex IndexOf(const Atlas& atlas) {
  InvertedIndex index(Vocabulary()->words());
  atlas.ForEachKeyframe(kMapper, [&](const Keyframe& keyframe) {
    index.Add(keyframe.id, Vocabulary()->Bag(keyframe.data->features.descriptors));
  });
  return index;
}

FrameLookup Ask(const Atlas& atlas, const KeyframeData& frame, const FrameLookupOptions& options = {}) {
  return LookUpFrame(atlas, IndexOf(atlas), *Vocabulary(), frame, options, {});
}

// The camera of the frame in the world, by what the lookup says.
double ErrorOf(const SurveyedWorld& world, const FrameLookup& lookup, double scale) {
  const KeyframeId lost = world.KeyframesOf(kLost).back();
  const Rigid3d truth = world.TrueCameraFromWorld(lost) * world.TrueCameraFromWorld(lookup.keyframe).Inverse();
  Rigid3d found = lookup.camera_from_keyframe;
  found = Rigid3d(found.rotation(), found.translation() / scale);
  return (found.Inverse().translation() - truth.Inverse().translation()).norm();
}

TEST(FrameLookup, AFrameIsFoundInTheMapOfAnotherSession) {
  SurveyedWorld world(1);
  const MapId map = world.Fly(kMapper, CirclePoses(0, 20, kCircle), {});
  const KeyframeData frame = LookAround(world, 10);
  const FrameLookup lookup = Ask(world.atlas, frame);
  ASSERT_EQ(lookup.outcome, FrameOutcome::kFound);
  EXPECT_EQ(lookup.map, map);
  EXPECT_EQ(lookup.keyframe.session, kMapper);
  EXPECT_GE(lookup.inliers, 30);
  EXPECT_LT(ErrorOf(world, lookup, 1.0), 0.03);
}

TEST(FrameLookup, TheSameQuestionGivesTheSameAnswer) {
  SurveyedWorld world(2);
  world.Fly(kMapper, CirclePoses(0, 20, kCircle), {});
  const KeyframeData frame = LookAround(world, 8);
  const FrameLookup first = Ask(world.atlas, frame);
  const FrameLookup second = Ask(world.atlas, frame);
  EXPECT_EQ(first.keyframe, second.keyframe);
  EXPECT_EQ(first.camera_from_keyframe.translation(), second.camera_from_keyframe.translation());
}

TEST(FrameLookup, AMonocularCameraIsFoundInAScaleFreeMapAndAStereoCameraIsNotLookedForThere) {
  SurveyedWorld world(3);
  SurveyOptions scale_free;
  scale_free.stereo = false;
  scale_free.map_from_world = Similarity3d(2.0, Eigen::Quaterniond::Identity(), {1.0, 2.0, 3.0});
  world.Fly(kMapper, CirclePoses(0, 20, kCircle), scale_free);
  const KeyframeData mono = LookAround(world, 10, false);
  const FrameLookup lookup = Ask(world.atlas, mono);
  ASSERT_EQ(lookup.outcome, FrameOutcome::kFound);
  EXPECT_LT(ErrorOf(world, lookup, 2.0), 0.03);
  KeyframeData stereo = mono;
  stereo.camera.baseline = 0.11;
  EXPECT_EQ(Ask(world.atlas, stereo).outcome, FrameOutcome::kNoCandidate);
}

TEST(FrameLookup, APlaceThatNobodyMappedIsNotFound) {
  SurveyedWorld world(4);
  world.Fly(kMapper, CirclePoses(0, 20, kCircle), {});
  SurveyedWorld elsewhere(5);
  const KeyframeData frame = LookAround(elsewhere, 10);
  const FrameLookup lookup = Ask(world.atlas, frame);
  EXPECT_FALSE(lookup.is_found());
  EXPECT_GT(lookup.candidates, 0U);
}

TEST(FrameLookup, AFrameThatShowsNothingIsNotCompared) {
  SurveyedWorld world(6);
  world.Fly(kMapper, CirclePoses(0, 20, kCircle), {});
  KeyframeData frame = LookAround(world, 10);
  frame.features.keypoints.resize(5);
  frame.features.descriptors.resize(5);
  EXPECT_EQ(Ask(world.atlas, frame).outcome, FrameOutcome::kFewFeatures);
}

TEST(FrameLookup, KeyframesThatTheIndexKnowsAndTheAtlasDoesNotArePassedOver) {
  SurveyedWorld world(7);
  world.Fly(kMapper, CirclePoses(0, 20, kCircle), {});
  const KeyframeData frame = LookAround(world, 10);
  const InvertedIndex index = IndexOf(world.atlas);
  EXPECT_EQ(LookUpFrame(Atlas(), index, *Vocabulary(), frame, {}, {}).outcome, FrameOutcome::kNoCandidate);
}

TEST(FrameLookup, FewerLandmarksThanAskedForAreNotEnough) {
  SurveyedWorld world(8);
  world.Fly(kMapper, CirclePoses(0, 20, kCircle), {});
  const KeyframeData frame = LookAround(world, 10);
  FrameLookupOptions strict;
  strict.min_inliers = 1000;
  EXPECT_EQ(Ask(world.atlas, frame, strict).outcome, FrameOutcome::kFewInliers);
  FrameLookupOptions exact;
  exact.observability.max_sigma_m = 1e-9;
  EXPECT_EQ(Ask(world.atlas, frame, exact).outcome, FrameOutcome::kUnobservable);
}

}  // namespace
}  // namespace pangaea::testing
