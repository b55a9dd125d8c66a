// What tracking and local mapping make of corrections and guests.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/map/consistency.h"
#include "common/map/covisibility.h"
#include "common/map/map_edit.h"
#include "common/map/spanning_tree.h"
#include "tests/agent/tracking/rendered_flight.h"

namespace pangaea {
namespace {

using ::testing::IsEmpty;
using testing::MakeWall;
using testing::RenderedFlight;

constexpr double kStep = 0.06;  // metres a frame: 1.2 m/s
constexpr SessionId kOwn = 1;
constexpr SessionId kOther = 2;

std::vector<Surface> OneWall() { return {MakeWall(-4.0, 8.0, 3.0, 3.0, 1)}; }

std::size_t Tracked(const std::vector<TrackingResult>& results) {
  return static_cast<std::size_t>(std::ranges::count_if(results, &TrackingResult::tracked));
}

// All of the map, as a server would send it that has it in another frame.
MapPiece Whole(const Atlas& atlas, MapId map, const Rigid3d& server_from_map, bool with_data) {
  PieceSelection selection;
  selection.map = map;
  selection.keyframes = ParentsFirst(atlas, map);
  if (!with_data) selection.held = {selection.keyframes.begin(), selection.keyframes.end()};
  selection.landmarks = LandmarksSeenBy(atlas, selection.keyframes);
  MapPiece piece = CutPiece(atlas, selection);
  for (PieceKeyframe& keyframe : piece.keyframes) {
    keyframe.camera_from_map = keyframe.camera_from_map * server_from_map.Inverse();
    keyframe.corrected_at = 1;
  }
  for (PieceLandmark& landmark : piece.landmarks) landmark.point_in_map = server_from_map * landmark.point_in_map;
  return piece;
}

TEST(CorrectedFlight, TrackingGoesOnWhenTheMapJumpsByAMetreAndTurns) {
  RenderedFlight flight(OneWall(), {});
  flight.FlyAlong(0.0, 1.5, kStep);
  const MapId map = flight.atlas().Maps().front();
  const Rigid3d server_from_map(ExpSo3({0.1, -0.3, 0.2}), {0.6, -0.7, 0.4});
  const Rigid3d before = flight.atlas().FindKeyframe({kOwn, 1})->camera_from_map;
  flight.Absorb({kOwn, 1, 1, 0, {Whole(flight.atlas(), map, server_from_map, false)}});
  const Rigid3d after = flight.atlas().FindKeyframe({kOwn, 1})->camera_from_map;
  EXPECT_GT((before.Inverse().translation() - after.Inverse().translation()).norm(), 1.0);
  const auto results = flight.FlyAlong(1.5, 3.0, kStep);
  EXPECT_EQ(Tracked(results), results.size());
  EXPECT_EQ(flight.Trajectories().size(), 1U);
  EXPECT_LT(flight.PositionError(), 0.01);
  EXPECT_THAT(CheckConsistency(flight.atlas()), IsEmpty());
  // What the server has placed stays there, whatever local mapping adjusts around it.
  const Rigid3d& last = flight.atlas().FindKeyframe({kOwn, 1})->camera_from_map;
  EXPECT_EQ(last.translation(), after.translation());
}

TEST(CorrectedFlight, FramesHangBelowAKeyframeThatIsOnItsWayIntoTheMap) {
  constexpr int kLag = 3;  // frames
  RenderedFlight flight(OneWall(), {});
  flight.LetMappingLag(kLag);
  const auto results = flight.FlyAlong(0.0, 6.0, kStep);
  KeyframeId under_way;
  int lagging = -1;
  int frames_below = 0;
  for (const TrackingResult& result : results) {
    if (!result.tracked || result.root) continue;
    if (result.keyframe) {
      under_way = result.keyframe->id;
      lagging = kLag;
    } else if (lagging-- >= 0) {
      EXPECT_EQ(result.reference, under_way) << "also in the frame at which it has come into the map";
      ++frames_below;
    }
  }
  EXPECT_GE(frames_below, kLag);
  std::size_t in_map = 0;
  for (const auto& [map, trajectory] : flight.Trajectories()) in_map += trajectory.size();
  EXPECT_EQ(in_map, Tracked(results)) << "none is lost on the way";
  EXPECT_LT(flight.PositionError(), 0.01);
}

TEST(CorrectedFlight, KeyframesThatTheServerDidNotKnowYetComeAlong) {
  RenderedFlight flight(OneWall(), {});
  flight.FlyAlong(0.0, 1.5, kStep);
  const Rigid3d server_from_map(ExpSo3({0.0, 0.2, 0.0}), {1.0, 0.0, 0.3});
  MapPiece piece = Whole(flight.atlas(), flight.atlas().Maps().front(), server_from_map, false);
  flight.FlyAlong(1.5, 2.5, kStep);
  ASSERT_GT(flight.atlas().keyframe_count(), piece.keyframes.size());
  flight.Absorb({kOwn, 1, 1, 0, {piece}});
  const auto results = flight.FlyAlong(2.5, 3.5, kStep);
  EXPECT_EQ(Tracked(results), results.size());
  EXPECT_LT(flight.PositionError(), 0.01);
}

TEST(CorrectedFlight, OverAMapOfAnotherSessionFewNewLandmarksAreMade) {
  RenderedFlight mapped(OneWall(), {}, kOther, 5);
  mapped.FlyAlong(0.0, 4.0, kStep);
  RenderedFlight alone(OneWall(), {}, kOwn);
  alone.FlyAlong(0.0, 3.0, kStep);

  RenderedFlight guided(OneWall(), {}, kOwn);
  guided.FlyAlong(0.0, 0.3, kStep);
  // Both began at the same place, so the server's frame is the agent's.
  MapPiece guests = Whole(mapped.atlas(), {kOther, 1}, Rigid3d(), true);
  guests.merged = {{kOwn, 1}};
  const std::size_t guest_keyframes = guests.keyframes.size();
  guided.Absorb({kOwn, 1, 1, 0, {guests}});
  EXPECT_EQ(guided.atlas().keyframe_count(kOther), guest_keyframes);
  const auto results = guided.FlyAlong(0.3, 3.0, kStep);
  EXPECT_EQ(Tracked(results), results.size());
  EXPECT_EQ(guided.atlas().Maps().size(), 1U);
  EXPECT_LT(guided.PositionError(), 0.02);
  EXPECT_THAT(CheckConsistency(guided.atlas()), IsEmpty());
  EXPECT_EQ(guided.atlas().keyframe_count(kOther), guest_keyframes);  // none is culled
  // Many of those it had made before the guests came are theirs by now.
  const auto made_alone = static_cast<double>(alone.atlas().landmark_count(kOwn));
  const auto made_guided = static_cast<double>(guided.atlas().landmark_count(kOwn));
  EXPECT_LT(made_guided, 0.6 * made_alone) << made_guided << " of " << made_alone;
}

TEST(CorrectedFlight, KeyframesOfOthersReplaceOnesOwnOnlyWhereTheyAreTwiceAsNear) {
  RenderedFlight mapped(OneWall(), {}, kOther, 5);
  mapped.FlyAlong(0.0, 4.0, kStep);
  const auto keyframes_made = [&](double others_view) {
    TrackingOptions options;
    options.keyframes.others_view = others_view;
    RenderedFlight guided(OneWall(), options, kOwn);
    guided.FlyAlong(0.0, 0.3, kStep);
    MapPiece guests = Whole(mapped.atlas(), {kOther, 1}, Rigid3d(), true);
    guests.merged = {{kOwn, 1}};
    guided.Absorb({kOwn, 1, 1, 0, {guests}});
    const auto results = guided.FlyAlong(0.3, 3.5, kStep);
    return std::ranges::count_if(results, [](const TrackingResult& result) { return result.keyframe.has_value(); });
  };
  EXPECT_GT(keyframes_made(TrackingOptions().keyframes.others_view), keyframes_made(1.0));

  TrackingOptions far;
  far.keyframes.others_view = 10.0;
  RenderedFlight alone(OneWall(), {});
  RenderedFlight alone_too(OneWall(), far);
  alone.FlyAlong(0.0, 3.5, kStep);
  alone_too.FlyAlong(0.0, 3.5, kStep);
  EXPECT_EQ(alone_too.atlas().keyframe_count(), alone.atlas().keyframe_count());
}

TEST(CorrectedFlight, ALostCameraGoesOnInAMapOfAnotherSessionThatTheServerSends) {
  RenderedFlight mapped(OneWall(), {}, kOther, 5);
  mapped.FlyAlong(0.0, 4.0, kStep);
  RenderedFlight flight({MakeWall(-4.0, 8.0, 3.0, 3.0, 1), MakeWall(20.0, 30.0, 3.0, 3.0, 2)}, {}, kOwn);
  flight.FlyAlong(22.0, 23.0, kStep);
  flight.FlyInTheDark();
  flight.Absorb({kOwn, 1, 1, 0, {Whole(mapped.atlas(), {kOther, 1}, Rigid3d(), true)}});
  EXPECT_EQ(flight.atlas().Maps().size(), 2U);
  const auto results = flight.FlyAlong(1.0, 3.0, kStep);
  EXPECT_GE(Tracked(results) + 5, results.size());
  EXPECT_EQ(results.back().map, (MapId{kOther, 1}));
  // Its keyframes hang below the others' in their map.
  EXPECT_GT(flight.atlas().FindMap({kOther, 1})->keyframes, mapped.atlas().keyframe_count());
  EXPECT_THAT(CheckConsistency(flight.atlas()), IsEmpty());
}

// A camera that was lost at one wall and sees the other one now, which another session has mapped.
class FoundFlight : public ::testing::Test {
 protected:
  FoundFlight() : mapped(OneWall(), {}, kOther, 5), flight(TwoWalls(), OnlyByHint(), kOwn) {
    mapped.FlyAlong(0.0, 4.0, kStep);
    flight.FlyAlong(22.0, 23.0, kStep);
    for (int i = 0; i < 10; ++i) flight.FlyInTheDark();
  }

  static std::vector<Surface> TwoWalls() {
    return {MakeWall(-4.0, 8.0, 3.0, 3.0, 1), MakeWall(20.0, 30.0, 3.0, 3.0, 2)};
  }
  // Without words of its own.
  static TrackingOptions OnlyByHint() {
    TrackingOptions options;
    options.recognition.learned_per_snapshot = 0;
    return options;
  }
  // The frame that a camera takes from there, by the other session's nearest keyframe.
  PlaceHint HintAt(double x) const {
    const Rigid3d camera_from_map(Eigen::Quaterniond::Identity(), {-x, 0.0, 0.0});
    PlaceHint hint;
    double nearest = 1e9;
    mapped.atlas().ForEachKeyframe([&](const Keyframe& keyframe) {
      const Rigid3d camera_from_keyframe = camera_from_map * keyframe.camera_from_map.Inverse();
      if (camera_from_keyframe.translation().norm() >= nearest) return;
      nearest = camera_from_keyframe.translation().norm();
      hint = {keyframe.id, camera_from_keyframe};
    });
    return hint;
  }
  void ReceiveThePlace() { flight.Absorb({kOwn, 1, 1, 0, {Whole(mapped.atlas(), {kOther, 1}, Rigid3d(), true)}}); }

  RenderedFlight mapped;
  RenderedFlight flight;
};

TEST_F(FoundFlight, WhileThePlaceIsOnItsWayNoMapBeginsAndThenTheNextFrameIsFound) {
  EXPECT_EQ(Tracked(flight.FlyAlong(1.0, 1.18, kStep)), 0U);
  flight.Suggest(HintAt(1.0));
  EXPECT_EQ(Tracked(flight.FlyAlong(1.18, 1.9, kStep)), 0U);
  EXPECT_EQ(flight.atlas().Maps().size(), 1U);
  ReceiveThePlace();
  // The camera is a metre away from where it was found.
  const auto results = flight.FlyAlong(1.9, 3.0, kStep);
  EXPECT_EQ(Tracked(results), results.size());
  EXPECT_EQ(results.front().map, (MapId{kOther, 1}));
  EXPECT_TRUE(results.front().keyframe);
  EXPECT_THAT(CheckConsistency(flight.atlas()), IsEmpty());
}

TEST_F(FoundFlight, AHintIsNotWaitedForForEver) {
  flight.FlyAlong(1.0, 1.12, kStep);
  flight.Suggest(HintAt(1.0));
  const TrackingOptions options;
  const auto results = flight.FlyAlong(1.12, 3.52, kStep);
  EXPECT_EQ(flight.atlas().Maps().size(), 2U);
  const auto most = static_cast<std::size_t>(options.frames_until_new_map + options.frames_for_hint);
  EXPECT_GE(Tracked(results) + most, results.size());
}

TEST_F(FoundFlight, FramesAreTheSessionsOwnAlsoWhileItsFirstKeyframeThereIsOnItsWayIntoTheMap) {
  flight.LetMappingLag(4);
  flight.Fly(testing::LookingAtTheWalls(1.0));
  flight.Suggest(HintAt(1.0));
  ReceiveThePlace();
  const auto results = flight.FlyAlong(1.06, 3.0, kStep);
  EXPECT_EQ(Tracked(results), results.size());
  for (const TrackingResult& result : results) EXPECT_EQ(result.reference.session, kOwn);
  const auto trajectories = flight.Trajectories();
  EXPECT_EQ(trajectories.at({kOther, 1}).size(), results.size());
  EXPECT_LT(flight.PositionError(), 0.02);
  EXPECT_THAT(CheckConsistency(flight.atlas()), IsEmpty());
}

TEST(CorrectedFlight, TheLastFrameBecomesAKeyframeSoThatThoseBeforeItShareWhatBecomesOfIt) {
  RenderedFlight flight(OneWall(), {});
  const auto results = flight.FlyAlong(0.0, 3.0, kStep);
  ASSERT_FALSE(results.back().keyframe);
  const std::int64_t last_ns = results.back().pose.stamp_ns;
  const auto landed = flight.Land();
  ASSERT_TRUE(landed);
  EXPECT_FALSE(flight.Land()) << "it is a keyframe now";
  const Keyframe& keyframe = *flight.atlas().FindKeyframe(*landed);
  EXPECT_EQ(keyframe.data->stamp_ns, last_ns);
  const auto before = flight.Trajectories().begin()->second;
  EXPECT_EQ(before.size(), results.size()) << "the frame is no second one";
  EXPECT_EQ(before.back().world_from_body.translation(), keyframe.camera_from_map.Inverse().translation());

  // The server moves the keyframe alone, by a decimetre.
  const Rigid3d shift(Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0});
  PieceSelection selection;
  selection.map = keyframe.map;
  selection.keyframes = {*landed};
  selection.held = {*landed};
  MapPiece piece = CutPiece(flight.atlas(), selection);
  piece.keyframes.front().camera_from_map = shift * piece.keyframes.front().camera_from_map;
  piece.keyframes.front().corrected_at = 1;
  flight.Absorb({kOwn, 1, 1, 0, {piece}});
  const auto after = flight.Trajectories().begin()->second;
  const auto moved = [&](std::size_t i) {
    return (after[i].world_from_body.translation() - before[i].world_from_body.translation()).norm();
  };
  EXPECT_NEAR(moved(after.size() - 1), 0.1, 1e-9);
  EXPECT_GT(moved(after.size() - 2), 0.05);
  EXPECT_LT(moved(after.size() - 2), 0.1);
  EXPECT_EQ(moved(0), 0.0);
}

TEST(CorrectedFlight, WithoutATrackedFrameAtItsEndAFlightGetsNoLastKeyframe) {
  RenderedFlight flight(OneWall(), {});
  EXPECT_FALSE(flight.Land());
  const TrackingResult first = flight.Fly(testing::LookingAtTheWalls(0.0));
  ASSERT_TRUE(first.root);
  EXPECT_FALSE(flight.Land()) << "the first frame is a keyframe already";
  double x = 0.0;
  while (!flight.Fly(testing::LookingAtTheWalls(x += kStep)).keyframe) ASSERT_LT(x, 3.0);
  EXPECT_FALSE(flight.Land()) << "the last frame is a keyframe already";
  flight.Fly(testing::LookingAtTheWalls(x += kStep));
  EXPECT_FALSE(flight.Land()) << "it would be next to one";
  flight.FlyAlong(x + kStep, x + 0.3, kStep);
  flight.FlyInTheDark();
  EXPECT_FALSE(flight.Land()) << "nobody knows where it ended";
}

}  // namespace
}  // namespace pangaea
