#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/evaluation/absolute_error.h"
#include "common/map/consistency.h"
#include "tests/agent/tracking/rendered_flight.h"

namespace pangaea {
namespace {

using ::testing::IsEmpty;
using testing::LookingAtTheWalls;
using testing::MakeWall;
using testing::RenderedFlight;

constexpr double kStep = 0.06;  // metres a frame: 1.2 m/s

// Two near walls without anything in common, a room's width away.
std::vector<Surface> TwoWalls() { return {MakeWall(-4.0, 6.0, 3.0, 3.0, 1), MakeWall(20.0, 30.0, 3.0, 3.0, 2)}; }

std::size_t Tracked(const std::vector<TrackingResult>& results) {
  return static_cast<std::size_t>(std::ranges::count_if(results, &TrackingResult::tracked));
}

void Darken(RenderedFlight& flight, int frames) {
  for (int i = 0; i < frames; ++i) EXPECT_FALSE(flight.FlyInTheDark().tracked);
}

TEST(Recovery, AKnownPlaceIsRecognisedInTheFirstFrameAfterTheDark) {
  RenderedFlight flight(TwoWalls(), {});
  flight.FlyAlong(0.0, 3.0, kStep);
  Darken(flight, 40);
  // Back where it began, which is far from where the camera was lost.
  const TrackingResult found = flight.Fly(LookingAtTheWalls(0.3));
  EXPECT_TRUE(found.tracked);
  EXPECT_EQ(Tracked(flight.FlyAlong(0.35, 1.5, kStep)), 19U);
  EXPECT_EQ(flight.Trajectories().size(), 1U);
  EXPECT_LT(flight.PositionError(), 0.01);
}

TEST(Recovery, AnUnknownPlaceBeginsANewMapAfterAFewFramesAndTheOldOneIsKept) {
  const TrackingOptions options;
  RenderedFlight flight(TwoWalls(), options);
  flight.FlyAlong(0.0, 2.0, kStep);
  Darken(flight, 40);
  const auto results = flight.FlyAlong(22.0, 24.0, kStep);
  EXPECT_EQ(results.size() - Tracked(results), static_cast<std::size_t>(options.frames_until_new_map) - 1);
  const auto trajectories = flight.Trajectories();
  ASSERT_EQ(trajectories.size(), 2U);
  EXPECT_GE(trajectories.begin()->second.size(), 33U);
  EXPECT_LT(flight.PositionError(), 0.01);
  EXPECT_THAT(CheckConsistency(flight.atlas()), IsEmpty());
}

TEST(Recovery, FromASmallMapTheCameraGoesOnInTheLargerOneThatItComesBackTo) {
  RenderedFlight flight(TwoWalls(), {});
  const auto first = flight.FlyAlong(0.0, 3.0, kStep);
  Darken(flight, 5);
  flight.FlyAlong(22.0, 23.2, kStep);
  Darken(flight, 5);
  const auto back = flight.FlyAlong(1.0, 2.0, kStep);
  EXPECT_EQ(back.front().map, first.front().map);
  EXPECT_EQ(Tracked(back), back.size());
  EXPECT_EQ(flight.Trajectories().size(), 2U);
  EXPECT_LT(flight.PositionError(), 0.01);
}

TEST(Recovery, AStretchOfDistantLandmarksAloneSplitsTheMapAndTheErrorIsLower) {
  // Near walls with an opening between them, through which there is only a wall 90 m away.
  const std::vector<Surface> surfaces = {MakeWall(-4.0, 6.0, 3.0, 3.0, 1), MakeWall(-80.0, 100.0, 90.0, 60.0, 3, 20.0),
                                         MakeWall(14.0, 24.0, 3.0, 3.0, 2)};
  const double end = 19.0;
  TrackingOptions blind;
  blind.observability.max_sigma_m = 1e9;
  RenderedFlight without(surfaces, blind);
  const auto all = without.FlyAlong(0.0, end, 2.0 * kStep);
  EXPECT_EQ(Tracked(all), all.size());
  EXPECT_EQ(without.Trajectories().size(), 1U);

  RenderedFlight with(surfaces, {});
  with.FlyAlong(0.0, end, 2.0 * kStep);
  EXPECT_GE(with.Trajectories().size(), 2U);
  // From 8.5 to 11.5 m neither of the near walls is in view; for half a metre the camera still knows where it is.
  for (const auto& [map, trajectory] : with.Trajectories()) {
    for (const StampedPose& pose : trajectory) {
      const double x = InterpolatePose(with.truth(), pose.stamp_ns, {})->translation().x();
      EXPECT_FALSE(x > 9.5 && x < 11.5) << "an uncertain frame at " << x;
    }
  }
  EXPECT_LT(with.PositionError(), 0.5 * without.PositionError());
}

}  // namespace
}  // namespace pangaea
