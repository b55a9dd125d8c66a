// Looks for duplicates that leave out what has not changed, against looks at everything.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/map/consistency.h"
#include "server/fusion/landmark_index.h"
#include "server/fusion/map_fusion.h"
#include "tests/server/fusion_world.h"

namespace pangaea::testing {
namespace {

using ::testing::IsEmpty;

constexpr SessionId kThird = 0x33;
const MapId kMap{kOlder, 1};

void Carry(const MapFusion& fusion, Atlas& atlas) {
  ApplyTolerantly(fusion.edits, atlas);
  for (const MapEdit& edit : Rebase(fusion.correction, atlas)) EXPECT_TRUE(Apply(edit, atlas).has_value());
}

MapFusion LookEverywhere(const Atlas& atlas) { return FuseDuplicates(atlas, kMap, {}, LookedAtMap(), {}); }

// As often as it finds something.
void LookUntilNothingIsFound(Atlas& atlas, LookedAtMap& seen) {
  for (int i = 0; i < 10; ++i) {
    const MapFusion fusion = FuseDuplicates(atlas, kMap, {}, seen, {});
    Carry(fusion, atlas);
    seen = *fusion.looked_at;
    if (fusion.edits.empty()) return;
  }
  ADD_FAILURE() << "every look finds something";
}

void MoveAll(const std::vector<KeyframeId>& keyframes, const Rigid3d& moved_from_map, Atlas& atlas) {
  Correction correction{.base = atlas, .map = kMap, .keyframes = {}, .landmarks = {}};
  for (const KeyframeId id : keyframes) {
    const Keyframe* keyframe = atlas.FindKeyframe(id);
    if (keyframe == nullptr) continue;
    correction.keyframes.push_back({id, keyframe->camera_from_map * moved_from_map.Inverse(), 1.0});
  }
  for (const MapEdit& edit : Rebase(correction, atlas)) ASSERT_TRUE(Apply(edit, atlas).has_value());
}

Rigid3d Sideways(double metres) { return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(metres, 0.0, 0.0)}; }

// Two sessions that flew the same way, one of which was rid of duplicates; a third one can be welded to it.
class Look : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  Look() : flown_(GetParam(), CirclePoses(0, 20, 40), 2, NarrowWindow()), atlas_(flown_.merged) {
    LookUntilNothingIsFound(atlas_, seen_);
  }

  static FusionOptions NarrowWindow() {
    FusionOptions options;
    options.window.keyframes = 5;
    return options;
  }

  // Over a quarter of the way.
  void WeldAThird() {
    SurveyOptions options;
    options.stamp_ns = 2'000'000'000'000;
    options.map_from_world = RandomFrame(GetParam() + 50);
    flown_.world.atlas = atlas_;
    flown_.world.Fly(kThird, CirclePoses(0, 5, 40), options);
    const PlaceMatch match =
        flown_.world.TrueMatch(flown_.world.KeyframesOf(kThird)[2], flown_.world.KeyframesOf(kOlder)[2]);
    const WeldingOutcome plan = PlanWelding(flown_.world.atlas, match, NarrowWindow(), {});
    ASSERT_TRUE(plan.has_value());
    atlas_ = flown_.world.atlas;
    testing::Carry(*plan, atlas_);
  }

  // How many changes in a row leave the next look nothing to do; `most`: all of them.
  template <typename Change>
  int ChangesUntilALook(int most, const Change& change) {
    for (int i = 0; i < most; ++i) {
      change();
      const MapFusion fusion = FuseDuplicates(atlas_, kMap, {}, seen_, {});
      seen_ = *fusion.looked_at;
      if (fusion.looks > 0) return i;
    }
    return most;
  }

  std::size_t DuplicatesAfter(const MapFusion& fusion) {
    Atlas atlas = atlas_;
    Carry(fusion, atlas);
    EXPECT_THAT(CheckConsistency(atlas), IsEmpty());
    return CountDuplicates(flown_.world, atlas);
  }

  WeldedFlights flown_;
  Atlas atlas_;
  LookedAtMap seen_;
};
INSTANTIATE_TEST_SUITE_P(Seeds, Look, ::testing::Range<std::uint64_t>(1, 4));

TEST_P(Look, TheFirstOneLooksAtEverything) {
  const MapFusion first = LookEverywhere(flown_.merged);
  const LandmarkIndex everything(flown_.merged, kMap, 0.4);
  std::size_t in_view = 0;
  for (const KeyframeId id : AllKeyframes(flown_.world)) {
    in_view += everything.InView(Viewpoint(*flown_.merged.FindKeyframe(id))).size();
  }
  EXPECT_GT(first.fused, 300U);
  EXPECT_EQ(first.looks, in_view);
}

TEST_P(Look, WhereNothingHasChangedNothingIsLookedFor) {
  EXPECT_EQ(FuseDuplicates(atlas_, kMap, {}, seen_, {}).looks, 0U);
}

TEST_P(Look, WhatMovesTogetherHasNotChanged) {
  MoveAll(AllKeyframes(flown_.world), Sideways(2.0), atlas_);
  EXPECT_EQ(FuseDuplicates(atlas_, kMap, {}, seen_, {}).looks, 0U);
}

TEST_P(Look, OfANewSessionItFindsWhatALookEverywhereFinds) {
  WeldAThird();
  const std::size_t before = CountDuplicates(flown_.world, atlas_);
  ASSERT_GT(before, 50U);
  const MapFusion whole = LookEverywhere(atlas_);
  const MapFusion changed = FuseDuplicates(atlas_, kMap, {}, seen_, {});
  EXPECT_LT(changed.looks, whole.looks * 2 / 3);
  EXPECT_NEAR(static_cast<double>(changed.fused), static_cast<double>(whole.fused), 2.0);
  EXPECT_LE(DuplicatesAfter(changed), DuplicatesAfter(whole) + 2);
  // Where the narrow weld lies badly, more than a quarter is left: by the look at everything, too.
  EXPECT_LT(DuplicatesAfter(changed), before / 2);
}

TEST_P(Look, SomethingNewAmongOldThingsIsFound) {
  // A landmark of many loses an observer, which then shows one of its own there.
  LandmarkId known;
  atlas_.ForEachLandmark([&](const Landmark& landmark) {
    if (landmark.observations.size() >= 8) known = landmark.id;
  });
  const Landmark landmark = *atlas_.FindLandmark(known);
  const Observation seen = landmark.observations[4];
  ASSERT_TRUE(Apply(RemoveObservation{known, seen.keyframe}, atlas_).has_value());
  const Keyframe& keyframe = *atlas_.FindKeyframe(seen.keyframe);
  const LandmarkId twin{kNewer, 6000};
  const AddLandmark add{.id = twin,
                        .reference = seen.keyframe,
                        .keypoint = seen.keypoint,
                        .point_in_reference = keyframe.camera_from_map * landmark.point_in_map};
  ASSERT_TRUE(Apply(add, atlas_).has_value());
  const MapFusion changed = FuseDuplicates(atlas_, kMap, {}, seen_, {});
  EXPECT_EQ(changed.after.Resolve(twin), known);
  EXPECT_LT(changed.looks, LookEverywhere(atlas_).looks / 20);
}

TEST_P(Look, WhatFitsOnlySinceKeyframesMovedIsFound) {
  Atlas atlas = flown_.merged;
  const std::vector<KeyframeId>& newer = flown_.world.KeyframesOf(kNewer);
  const std::vector<KeyframeId> tail(newer.begin() + 10, newer.end());
  MoveAll(tail, Sideways(0.3), atlas);
  LookedAtMap seen;
  LookUntilNothingIsFound(atlas, seen);
  const std::size_t before = CountDuplicates(flown_.world, atlas);
  ASSERT_GT(before, 100U);
  MoveAll(tail, Sideways(-0.3), atlas);
  const MapFusion whole = LookEverywhere(atlas);
  const MapFusion changed = FuseDuplicates(atlas, kMap, {}, seen, {});
  EXPECT_GT(whole.fused, before / 2);
  EXPECT_NEAR(static_cast<double>(changed.fused), static_cast<double>(whole.fused), 0.03 * static_cast<double>(before));
}

TEST_P(Look, SmallMotionsAddUp) {
  const std::vector<KeyframeId>& newer = flown_.world.KeyframesOf(kNewer);
  const std::vector<KeyframeId> tail(newer.begin() + 10, newer.end());
  const int silent = ChangesUntilALook(40, [&] { MoveAll(tail, Sideways(0.0003), atlas_); });
  EXPECT_GE(silent, 1) << "each by itself is too small";
  EXPECT_LT(silent, 40);
}

TEST_P(Look, ObserversThatGoOneByOneAddUp) {
  LandmarkId seen_most;
  std::size_t most = 0;
  atlas_.ForEachLandmark([&](const Landmark& landmark) {
    if (landmark.observations.size() <= most) return;
    most = landmark.observations.size();
    seen_most = landmark.id;
  });
  ASSERT_GE(most, 8U);
  const int half = static_cast<int>(most / 2);
  const int silent = ChangesUntilALook(half, [&] {
    const Landmark& landmark = *atlas_.FindLandmark(seen_most);
    const auto other = std::ranges::find_if(landmark.observations, [&](const Observation& observation) {
      return observation.keyframe != landmark.reference;
    });
    ASSERT_TRUE(Apply(RemoveObservation{seen_most, other->keyframe}, atlas_).has_value());
  });
  EXPECT_GE(silent, 2) << "each by itself is too little";
  EXPECT_LT(silent, half);
}

TEST_P(Look, OneThatWasStoppedIsNotRemembered) {
  WeldAThird();
  std::stop_source stop;
  stop.request_stop();
  const MapFusion stopped = FuseDuplicates(atlas_, kMap, {}, seen_, stop.get_token());
  EXPECT_THAT(stopped.edits, IsEmpty());
  EXPECT_FALSE(stopped.looked_at.has_value());
}

TEST_P(Look, AFusionThatWasNotTakenIsFoundAgain) {
  WeldAThird();
  const MapFusion first = FuseDuplicates(atlas_, kMap, {}, seen_, {});
  const MapFusion second = FuseDuplicates(atlas_, kMap, {}, *first.looked_at, {});
  ASSERT_GT(first.fused, 30U);
  EXPECT_GE(second.fused, first.fused * 8 / 10);
  EXPECT_LT(second.looks, first.looks);
}

TEST_P(Look, OfAMapThatWasCulledItFindsWhatIsTwice) {
  WeldAThird();
  std::size_t culled = 0;
  for (const KeyframeId id : flown_.world.KeyframesOf(kNewer)) {
    if (id.counter % 3 == 0 && Apply(RemoveKeyframe{id}, atlas_)) ++culled;
  }
  ASSERT_GT(culled, 3U);
  const std::size_t before = CountDuplicates(flown_.world, atlas_);
  const MapFusion changed = FuseDuplicates(atlas_, kMap, {}, seen_, {});
  EXPECT_GT(changed.fused, 30U);
  // The cull lets old landmarks fit each other that did not before. Those that lost few observers wait for a change of
  // their own: none in most worlds.
  EXPECT_LE(DuplicatesAfter(changed), DuplicatesAfter(LookEverywhere(atlas_)) + before / 12);
}

// Of keyframes that another map brings in nothing is known, whatever was seen of them there.
TEST_P(Look, OfAMapThatTookInAnotherOneItFindsWhatIsTwice) {
  const LookedAtMap alone = LookedAtMap::Of(flown_.world.atlas, kMap);
  const MapFusion changed = FuseDuplicates(flown_.merged, kMap, {}, alone, {});
  const MapFusion whole = LookEverywhere(flown_.merged);
  EXPECT_GT(changed.fused, 300U);
  EXPECT_NEAR(static_cast<double>(changed.fused), static_cast<double>(whole.fused), 5.0);
  EXPECT_LT(changed.looks, whole.looks);
}

}  // namespace
}  // namespace pangaea::testing
