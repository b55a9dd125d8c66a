#include "agent/tracking/recognition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "agent/mapping/local_mapper.h"
#include "common/map/forgetting.h"
#include "common/map/map_edit.h"
#include "common/place/vocabulary_file.h"
#include "tests/agent/mapping_synthetic_world.h"

namespace pangaea {
namespace {

using testing::CirclePose;
using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::SyntheticWorld;

constexpr int kKeyframes = 12;

// A round through a synthetic room, mapped.
class RecognitionTest : public ::testing::Test {
 protected:
  RecognitionTest() : world({}), mapper(1, LocalMappingOptions()), vocabulary(OpenVocabulary().value()) {
    NoStageRecorder stages;
    for (int k = 0; k < kKeyframes; ++k) mapper.Insert(world.NextKeyframe(CirclePose(k, 40), mapper.atlas()), stages);
    atlas = mapper.atlas();
  }

  // What a camera sees from there, as another view of the corners.
  Features Look(const Rigid3d& camera_from_world) {
    Features features = world.NextKeyframe(camera_from_world, mapper.atlas()).data->features;
    for (Keypoint& keypoint : features.keypoints) keypoint.u_right = -1.0F;
    return features;
  }
  Rigid3d TruePose(const Rigid3d& camera_from_world) const {
    return camera_from_world * world.true_camera_from_world({1, 1}).Inverse();
  }
  static double Distance(const Rigid3d& a, const Rigid3d& b) {
    return (a.Inverse().translation() - b.Inverse().translation()).norm();
  }

  SyntheticWorld world;
  LocalMapper mapper;
  std::shared_ptr<const VocabularyTree> vocabulary;
  Atlas atlas;
};

TEST_F(RecognitionTest, TheMemoryNamesTheKeyframeThatShowsTheSame) {
  PlaceMemory memory(vocabulary);
  memory.Follow(atlas, 100);
  EXPECT_EQ(memory.size(), atlas.keyframe_count());
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    EXPECT_EQ(memory.Candidates(keyframe.data->features.descriptors, 3).front(), keyframe.id);
  });
}

TEST_F(RecognitionTest, TheMemoryLearnsAFewKeyframesAtATime) {
  PlaceMemory memory(vocabulary);
  memory.Follow(atlas, 4);
  EXPECT_EQ(memory.size(), 4U);
  memory.Follow(atlas, 4);
  EXPECT_EQ(memory.size(), 8U);
}

TEST_F(RecognitionTest, TheMemoryForgetsWhatWasCulled) {
  PlaceMemory memory(vocabulary);
  memory.Follow(atlas, 100);
  const KeyframeId culled{1, 5};
  ASSERT_NE(atlas.FindKeyframe(culled), nullptr);
  const auto features = atlas.FindKeyframe(culled)->data->features;
  ASSERT_TRUE(Apply(RemoveKeyframe{culled}, atlas));
  memory.Follow(atlas, 100);
  EXPECT_EQ(memory.size(), atlas.keyframe_count());
  EXPECT_THAT(memory.Candidates(features.descriptors, 100), Not(Contains(culled)));
}

TEST_F(RecognitionTest, TheMemoryForgetsWhatTheMapForgotAndLearnsItAgain) {
  PlaceMemory memory(vocabulary);
  memory.Follow(atlas, 100);
  const KeyframeId id{1, 5};
  const auto data = atlas.FindKeyframe(id)->data;
  Forget(atlas, std::vector<ForgottenKeyframe>{{id}});
  memory.Follow(atlas, 100);
  EXPECT_EQ(memory.size(), atlas.keyframe_count() - 1);
  EXPECT_THAT(memory.Candidates(data->features.descriptors, 100), Not(Contains(id)));
  ASSERT_TRUE(Apply(AddKeyframe{id, {}, {}, {}, data}, atlas));
  memory.Follow(atlas, 100);
  EXPECT_EQ(memory.Candidates(data->features.descriptors, 3).front(), id);
}

TEST_F(RecognitionTest, WhatIsNotAdmittedIsNoCandidate) {
  PlaceMemory memory(vocabulary);
  memory.Follow(atlas, 100);
  const auto& descriptors = atlas.FindKeyframe({1, 2})->data->features.descriptors;
  const auto none = [](const KeyframeId&) { return false; };
  EXPECT_THAT(memory.Candidates(descriptors, 10, none), IsEmpty());
}

TEST_F(RecognitionTest, GuidedSearchFindsThePoseFromOneThatIsOffByAHandsBreadth) {
  const Rigid3d camera_from_world = CirclePose(7, 40);
  const Features features = Look(camera_from_world);
  const LocalMap local_map = CollectLocalMap(atlas, {1, 7}, TemplateStore(10), {}, {});
  const Rigid3d truth = TruePose(camera_from_world);
  Vector6d error;
  error << 0.05, -0.04, 0.03, 0.01, -0.01, 0.01;
  const auto found = LocateByDescriptors(world.camera(), features, atlas, Rigid3d::Exp(error) * truth, local_map, {});
  ASSERT_TRUE(found);
  EXPECT_LT(Distance(found->pose.camera_from_map, truth), 0.02);
  EXPECT_GE(found->pose.inliers, 50);
  for (const LandmarkMatch& match : found->matches) {
    const auto is_there = [&](const Keypoint& keypoint) {
      return Eigen::Vector2d(keypoint.u, keypoint.v) == match.pixel && keypoint.octave == match.octave;
    };
    EXPECT_TRUE(std::any_of(features.keypoints.begin(), features.keypoints.end(), is_there));
  }
}

TEST_F(RecognitionTest, WhereACandidateItselfShowsTooLittleTheKeyframesAroundItDo) {
  const Rigid3d camera_from_world = CirclePose(3, 40);
  const Features features = Look(camera_from_world);
  const std::vector<KeyframeId> candidates = {{1, 11}, {1, 99}};  // one that looks elsewhere, one that never was
  EXPECT_THAT(Relocalize(world.camera(), features, atlas, candidates, 1, {}, 1), IsEmpty());
  const auto poses = Relocalize(world.camera(), features, atlas, candidates, 6, {}, 1);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0].keyframe, candidates[0]);
  EXPECT_LT(Distance(poses[0].camera_from_map, TruePose(camera_from_world)), 0.05);
}

TEST_F(RecognitionTest, AWindowIsTriedWhereTheFirstPoseIsNotTrusted) {
  const Recognition recognition(world.camera(), {}, vocabulary, 1);
  const Rigid3d camera_from_world = CirclePose(3, 40);
  const Features features = Look(camera_from_world);
  const std::vector<KeyframeId> candidates = {{1, 11}, {1, 4}};  // the second one's own landmarks give a pose
  int judged = 0;
  const auto all_but_the_first = [&](const LocatedFrame&, const LocalMap&) { return ++judged > 1; };
  const auto surroundings = [&](KeyframeId id) { return CollectLocalMap(atlas, id, TemplateStore(10), {}, {}); };
  EXPECT_FALSE(recognition.Locate(features, atlas, candidates, surroundings, all_but_the_first));
  judged = 0;
  const auto found = recognition.LocateWidely(features, atlas, candidates, surroundings, all_but_the_first);
  ASSERT_TRUE(found);
  EXPECT_LT(Distance(found->located.pose.camera_from_map, TruePose(camera_from_world)), 0.02);
}

TEST_F(RecognitionTest, AFrameIsLocatedWithoutAnyPrediction) {
  Recognition recognition(world.camera(), {}, vocabulary, 1);
  for (int i = 0; i < kKeyframes; ++i) recognition.Follow(atlas);
  const Rigid3d camera_from_world = CirclePose(4, 40);
  const Features features = Look(camera_from_world);
  const auto locate = [&](auto trust) {
    return recognition.Locate(
        features, atlas, recognition.Candidates(features, {}),
        [&](KeyframeId id) { return CollectLocalMap(atlas, id, TemplateStore(10), {}, {}); }, trust);
  };
  const auto found = locate([](const LocatedFrame&, const LocalMap&) { return true; });
  ASSERT_TRUE(found);
  EXPECT_EQ(found->map, (MapId{1, 1}));
  EXPECT_LT(Distance(found->located.pose.camera_from_map, TruePose(camera_from_world)), 0.02);
  EXPECT_FALSE(locate([](const LocatedFrame&, const LocalMap&) { return false; }));
}

}  // namespace
}  // namespace pangaea
