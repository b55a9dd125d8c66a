#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "server/place_recognition/place_recognizer.h"
#include "tests/server/read_vocabulary.h"
#include "tests/server/surveyed_world.h"

namespace pangaea::testing {
namespace {

constexpr SessionId kFirst = 0xa;
constexpr SessionId kSecond = 0xb;
constexpr int kCircle = 36;  // poses of a whole round

Similarity3d SomeFrame(double scale) {
  return Similarity3d(scale, Eigen::Quaterniond(0.8, 0.1, -0.3, 0.5).normalized(), {3.0, -2.0, 1.0});
}

// The same keyframes and landmarks, but what keyframe `id` shows at keypoint k is described by describe(id, k).
using Describe = std::function<Descriptor(const Keyframe&, std::uint32_t)>;
Atlas Redescribed(const Atlas& atlas, const Describe& describe) {
  Atlas result;
  const auto apply = [&](const MapEdit& edit) { EXPECT_TRUE(Apply(edit, result).has_value()) << KindName(edit); };
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    auto data = std::make_shared<KeyframeData>(*keyframe.data);
    for (std::uint32_t k = 0; k < data->features.descriptors.size(); ++k) {
      data->features.descriptors[k] = describe(keyframe, k);
    }
    const Keyframe* parent = atlas.FindKeyframe(keyframe.parent);
    const Rigid3d parent_from_map = parent == nullptr ? Rigid3d() : parent->camera_from_map;
    apply(AddKeyframe{keyframe.id, keyframe.map, keyframe.parent, keyframe.camera_from_map * parent_from_map.Inverse(),
                      std::move(data)});
  });
  atlas.ForEachLandmark([&](const Landmark& landmark) {
    const Keyframe& reference = *atlas.FindKeyframe(landmark.reference);
    for (const Observation& observation : landmark.observations) {
      if (observation.keyframe != landmark.reference) continue;
      apply(AddLandmark{landmark.id, landmark.reference, observation.keypoint,
                        reference.camera_from_map * landmark.point_in_map});
    }
    for (const Observation& observation : landmark.observations) {
      if (observation.keyframe != landmark.reference) {
        apply(AddObservation{landmark.id, observation.keyframe, observation.keypoint});
      }
    }
  });
  return result;
}

class PlaceRecognitionTest : public ::testing::Test {
 protected:
  PlaceRecognizer Recognizer(const Atlas& atlas, const PlaceRecognitionOptions& options = {}) {
    PlaceRecognizer recognizer(Vocabulary(), options);
    recognizer.Synchronize(atlas);
    return recognizer;
  }
  NoStageRecorder stages_;
};

struct Discovery {
  std::vector<PlaceMatch> matches;
  std::vector<PlaceReport> reports;
};
Discovery AskAll(PlaceRecognizer& recognizer, const Atlas& atlas, const std::vector<KeyframeId>& queries) {
  NoStageRecorder stages;
  Discovery discovery;
  for (const KeyframeId query : queries) {
    PlaceRecognition recognition = recognizer.Recognize(atlas, query, stages);
    std::ranges::move(recognition.matches, std::back_inserter(discovery.matches));
    discovery.reports.push_back(recognition.report);
  }
  return discovery;
}

// Translation in metres of the candidate's map, rotation in radians, logarithm of the scale.
void ExpectNear(const SurveyedWorld& world, const PlaceMatch& match, double translation, double rotation,
                double log_scale) {
  const Similarity3d truth = world.TrueMatch(match.query, match.candidate).candidate_from_query;
  const Similarity3d& found = match.candidate_from_query;
  EXPECT_LT((found.translation() - truth.translation()).norm(), translation);
  EXPECT_LT(LogSo3(found.rotation() * truth.rotation().conjugate()).norm(), rotation);
  EXPECT_LE(std::abs(std::log(found.scale() / truth.scale())), log_scale);
}

// Most of the pairs are one corner, and no landmark is in two pairs.
void ExpectTruePairs(const SurveyedWorld& world, const PlaceMatch& match) {
  std::set<LandmarkId> once;
  std::size_t true_pairs = 0;
  for (const auto& [query, candidate] : match.landmarks) {
    EXPECT_TRUE(once.insert(query).second);
    EXPECT_TRUE(once.insert(candidate).second);
    true_pairs += world.CornerOf(world.atlas.FindLandmark(query)->observations.front()) ==
                  world.CornerOf(world.atlas.FindLandmark(candidate)->observations.front());
  }
  EXPECT_EQ(match.landmarks.size(), match.evidence.inliers);
  EXPECT_GE(static_cast<double>(true_pairs), 0.97 * static_cast<double>(match.landmarks.size()));
}

TEST_F(PlaceRecognitionTest, TwoStereoSessionsOfOneRoomAreJoinedByTheTrueMotion) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SurveyedWorld world(seed);
    world.Fly(kFirst, CirclePoses(0, 15, kCircle), {});
    world.Fly(kSecond, CirclePoses(5, 12, kCircle), {.map_from_world = SomeFrame(1.0)});
    PlaceRecognizer recognizer = Recognizer(world.atlas);
    const Discovery found = AskAll(recognizer, world.atlas, world.KeyframesOf(kSecond));
    EXPECT_GE(found.matches.size(), 6U) << "of eight revisits, seed " << seed;
    for (const PlaceMatch& match : found.matches) {
      EXPECT_EQ(match.candidate.session, kFirst);
      EXPECT_TRUE(match.metric);
      EXPECT_EQ(match.candidate_from_query.scale(), 1.0);
      EXPECT_GE(match.evidence.agreeing, 3U);
      ExpectNear(world, match, 0.02, 0.005, 0.0);
      ExpectTruePairs(world, match);
    }
  }
}

TEST_F(PlaceRecognitionTest, TheScaleOfAMonocularSessionIsFound) {
  for (const double scale : {0.3, 2.5}) {
    for (const bool first_is_stereo : {true, false}) {
      SurveyedWorld world(7);
      world.Fly(kFirst, CirclePoses(0, 12, kCircle), {.stereo = first_is_stereo, .map_from_world = {}});
      world.Fly(kSecond, CirclePoses(3, 9, kCircle), {.stereo = false, .map_from_world = SomeFrame(scale)});
      PlaceRecognizer recognizer = Recognizer(world.atlas);
      const Discovery found = AskAll(recognizer, world.atlas, world.KeyframesOf(kSecond));
      EXPECT_GE(found.matches.size(), 4U) << "of seven revisits, scale " << scale;
      for (const PlaceMatch& match : found.matches) {
        EXPECT_FALSE(match.metric);
        ExpectNear(world, match, 0.03, 0.005, 0.01);
        ExpectTruePairs(world, match);
      }
    }
  }
}

TEST_F(PlaceRecognitionTest, ALoopIsFoundWhereTheMapForgotThatItWasHere) {
  SurveyedWorld world(3);
  Vector6d drift = Vector6d::Zero();
  drift.x() = 0.01;
  // Once around and a quarter more: what was not seen in ten keyframes is new to the map.
  world.Fly(kFirst, CirclePoses(0, kCircle + 9, kCircle),
            {.map_from_world = {}, .drift_per_keyframe = drift, .remembered = 10});
  const std::vector<KeyframeId>& keyframes = world.KeyframesOf(kFirst);
  PlaceRecognizer recognizer(Vocabulary(), {});
  std::size_t loops = 0;
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const PlaceRecognition recognition = recognizer.Recognize(world.atlas, keyframes[i], stages_);
    for (const PlaceMatch& match : recognition.matches) {
      ++loops;
      EXPECT_GE(match.query.counter, match.candidate.counter + 10);
      EXPECT_GE(i, 20U) << "it has not come back yet";
      ExpectNear(world, match, 0.05, 0.01, 0.0);
    }
  }
  EXPECT_GE(loops, 6U) << "of ten keyframes in known places";
}

TEST_F(PlaceRecognitionTest, WhatTheMapKnowsToBeNearIsNeverACandidate) {
  SurveyedWorld world(4);
  // Back and forth, and the map remembers.
  std::vector<Rigid3d> poses = CirclePoses(0, 5, kCircle);
  poses.insert(poses.end(), poses.rbegin(), poses.rend());
  world.Fly(kFirst, poses, {});
  PlaceRecognizer recognizer = Recognizer(world.atlas);
  for (const PlaceReport& report : AskAll(recognizer, world.atlas, world.KeyframesOf(kFirst)).reports) {
    EXPECT_EQ(report.outcome, PlaceOutcome::kNoCandidate);
    EXPECT_EQ(report.candidates, 0U);
  }
}

TEST_F(PlaceRecognitionTest, TheSameDescriptorsAtOtherPlacesAreNoPlace) {
  SurveyedWorld world(5);
  world.Fly(kFirst, CirclePoses(0, 10, kCircle), {});
  world.Fly(kSecond, CirclePoses(2, 8, kCircle), {});
  // The second session's pictures hold the same corners in another arrangement: for the bags of words nothing changes.
  const Atlas atlas = Redescribed(world.atlas, [](const Keyframe& keyframe, std::uint32_t k) {
    const auto& descriptors = keyframe.data->features.descriptors;
    return keyframe.id.session == kFirst ? descriptors[k] : descriptors[(k * 7919U + 13U) % descriptors.size()];
  });
  PlaceRecognizer recognizer = Recognizer(atlas);
  const Discovery found = AskAll(recognizer, atlas, world.KeyframesOf(kSecond));
  EXPECT_TRUE(found.matches.empty());
  EXPECT_TRUE(std::ranges::any_of(found.reports, [](const PlaceReport& report) {
    return report.outcome == PlaceOutcome::kNoMotion;
  })) << "they do look alike";
}

TEST_F(PlaceRecognitionTest, APosterThatHangsInTwoRoomsDoesNotMakeThemOne) {
  SurveyedWorld world(6, 8000);
  const std::vector<Rigid3d> poses = CirclePoses(0, 12, kCircle);
  world.Fly(kFirst, poses, {});
  world.Fly(kSecond, poses, {});
  // The poster: what lies near the centre of the seventh picture. All else looks different to the second session.
  const Rigid3d& seventh = poses[6];
  const auto on_poster = [&](const Keyframe& keyframe, std::uint32_t k) {
    const Eigen::Vector3d point = seventh * world.CornerPosition(world.CornerOf({keyframe.id, k}));
    return point.z() > 0.0 && (point.head<2>() / point.z()).norm() < 0.3;
  };
  const Atlas atlas = Redescribed(world.atlas, [&](const Keyframe& keyframe, std::uint32_t k) {
    Descriptor descriptor = keyframe.data->features.descriptors[k];
    if (keyframe.id.session == kSecond && !on_poster(keyframe, k)) {
      for (std::uint64_t& word : descriptor.words) word = ~word;
    }
    return descriptor;
  });
  PlaceRecognizer recognizer = Recognizer(atlas);
  const Discovery found = AskAll(recognizer, atlas, world.KeyframesOf(kSecond));
  EXPECT_TRUE(found.matches.empty());
  EXPECT_TRUE(std::ranges::any_of(found.reports, [](const PlaceReport& report) {
    return report.outcome == PlaceOutcome::kContradicted;
  })) << "the poster itself fits";
}

TEST_F(PlaceRecognitionTest, AMotionWaitsUntilThreeKeyframesAgree) {
  SurveyedWorld world(8);
  world.Fly(kFirst, CirclePoses(0, 10, kCircle), {});
  PlaceRecognizer recognizer = Recognizer(world.atlas);
  for (int k = 3; k <= 5; ++k) {
    world.Fly(kSecond, CirclePoses(k, k, kCircle), {.map_from_world = SomeFrame(1.0)});
    const KeyframeId query = world.KeyframesOf(kSecond).back();
    const PlaceRecognition recognition = recognizer.Recognize(world.atlas, query, stages_);
    if (k < 5) {
      EXPECT_EQ(recognition.report.outcome, PlaceOutcome::kFewAgreeing);
      EXPECT_TRUE(recognition.matches.empty());
      EXPECT_EQ(recognizer.hypotheses().size(), 1U);
    } else {
      ASSERT_EQ(recognition.matches.size(), 1U);
      EXPECT_EQ(recognition.matches.front().query, query);
      EXPECT_GE(recognition.matches.front().evidence.agreeing, 3U);
      EXPECT_TRUE(recognizer.hypotheses().empty());
      ExpectNear(world, recognition.matches.front(), 0.02, 0.005, 0.0);
    }
  }
}

TEST_F(PlaceRecognitionTest, AMotionThatNobodyConfirmsIsForgotten) {
  SurveyedWorld world(8);
  world.Fly(kFirst, CirclePoses(0, 10, kCircle), {});
  PlaceRecognitionOptions options;
  options.agreement.patience = 3;
  PlaceRecognizer recognizer = Recognizer(world.atlas, options);
  world.Fly(kSecond, CirclePoses(3, 3, kCircle), {});
  recognizer.Recognize(world.atlas, world.KeyframesOf(kSecond).back(), stages_);
  ASSERT_EQ(recognizer.hypotheses().size(), 1U);
  // The other side of the room, where the first session never was.
  for (int k = 22; k < 26; ++k) {
    world.Fly(kSecond, CirclePoses(k, k, kCircle), {});
    recognizer.Recognize(world.atlas, world.KeyframesOf(kSecond).back(), stages_);
  }
  EXPECT_TRUE(recognizer.hypotheses().empty());
}

TEST_F(PlaceRecognitionTest, WhatIsRemovedFromTheIndexIsRecognisedNoMore) {
  SurveyedWorld world(9);
  world.Fly(kFirst, CirclePoses(0, 6, kCircle), {});
  world.Fly(kSecond, CirclePoses(2, 5, kCircle), {});
  const KeyframeId query = world.KeyframesOf(kSecond).back();
  PlaceRecognizer recognizer = Recognizer(world.atlas);
  ASSERT_FALSE(recognizer.Recognize(world.atlas, query, stages_).matches.empty());
  for (const KeyframeId id : world.KeyframesOf(kFirst)) EXPECT_TRUE(recognizer.Remove(id));
  EXPECT_EQ(recognizer.Recognize(world.atlas, query, stages_).report.outcome, PlaceOutcome::kNoCandidate);
  EXPECT_FALSE(recognizer.Remove(world.KeyframesOf(kFirst).front()));
  recognizer.Synchronize(world.atlas);
  EXPECT_FALSE(recognizer.Recognize(world.atlas, query, stages_).matches.empty());
}

TEST_F(PlaceRecognitionTest, SynchronisingTakesOutWhatTheAtlasHasLost) {
  SurveyedWorld world(9);
  world.Fly(kFirst, CirclePoses(0, 6, kCircle), {});
  PlaceRecognizer recognizer = Recognizer(world.atlas);
  EXPECT_EQ(recognizer.index().size(), 7U);
  const Atlas before = world.atlas;
  const KeyframeId culled = world.KeyframesOf(kFirst).back();
  ASSERT_TRUE(Apply(RemoveKeyframe{culled}, world.atlas).has_value());
  EXPECT_EQ(recognizer.Recognize(world.atlas, culled, stages_).report.outcome, PlaceOutcome::kUnknownKeyframe);
  recognizer.Synchronize(world.atlas);
  EXPECT_EQ(recognizer.index().size(), 6U);
  EXPECT_EQ(recognizer.index().Find(culled), nullptr);
}

TEST_F(PlaceRecognitionTest, KeyframesOfTheIndexThatTheSnapshotLacksArePassedOver) {
  SurveyedWorld world(10);
  world.Fly(kSecond, CirclePoses(2, 5, kCircle), {});
  const Atlas snapshot = world.atlas;
  world.Fly(kFirst, CirclePoses(0, 6, kCircle), {});
  PlaceRecognizer recognizer = Recognizer(world.atlas);
  const KeyframeId query = world.KeyframesOf(kSecond).back();
  EXPECT_EQ(recognizer.Recognize(snapshot, query, stages_).report.outcome, PlaceOutcome::kNoCandidate);
  EXPECT_FALSE(recognizer.Recognize(world.atlas, query, stages_).matches.empty());
}

TEST_F(PlaceRecognitionTest, TheSameSeedGivesTheSameBits) {
  SurveyedWorld world(11);
  world.Fly(kFirst, CirclePoses(0, 8, kCircle), {});
  world.Fly(kSecond, CirclePoses(2, 6, kCircle), {});
  PlaceRecognizer one = Recognizer(world.atlas), other = Recognizer(world.atlas);
  const auto first = AskAll(one, world.atlas, world.KeyframesOf(kSecond)).matches;
  const auto second = AskAll(other, world.atlas, world.KeyframesOf(kSecond)).matches;
  ASSERT_EQ(first.size(), second.size());
  ASSERT_FALSE(first.empty());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].candidate, second[i].candidate);
    EXPECT_EQ(first[i].landmarks, second[i].landmarks);
    EXPECT_EQ(first[i].candidate_from_query.translation(), second[i].candidate_from_query.translation());
    EXPECT_EQ(first[i].candidate_from_query.rotation().coeffs(), second[i].candidate_from_query.rotation().coeffs());
  }
}

}  // namespace
}  // namespace pangaea::testing
