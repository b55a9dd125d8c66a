#include "common/simulation/flight.h"

#include <gtest/gtest.h>

#include <vector>

#include "common/simulation/floor_plan.h"

namespace pangaea {
namespace {

// Only the solids matter to a flight: nothing needs painting.
const Scene& SolidsOfHall(std::uint64_t seed) {
  static std::vector<Scene> scenes = [] {
    std::vector<Scene> all;
    for (std::uint64_t s = 0; s < 6; ++s) all.push_back(PlanHall(s).scene);
    return all;
  }();
  return scenes[seed];
}

class FlightOfSeed : public testing::TestWithParam<std::uint64_t> {
 protected:
  Flight Fly(int session) const {
    FlightOptions options;
    options.seed = GetParam();
    options.session = session;
    return Flight(scene_, options);
  }
  const Scene& scene_ = SolidsOfHall(GetParam());
};

TEST_P(FlightOfSeed, StaysClearOfEverythingForHours) {
  for (int session = 0; session < 4; ++session) {
    const Flight flight = Fly(session);
    for (double t = 0.0; t < 120.0; t += 0.1) {
      EXPECT_GT(scene_.Clearance(flight.WorldFromBody(t).translation()), 0.6) << "session " << session << " at " << t;
    }
    for (double t = 7200.0; t < 7300.0; t += 0.1) {
      EXPECT_GT(scene_.Clearance(flight.WorldFromBody(t).translation()), 0.6) << "session " << session << " at " << t;
    }
  }
}

TEST_P(FlightOfSeed, IsSmoothAndAboutAsFastAsAsked) {
  constexpr double kStep = 0.005;
  const Flight flight = Fly(1);
  Rigid3d before = flight.WorldFromBody(0.0);
  Eigen::Vector3d velocity_before = flight.Velocity(0.0);
  for (double t = kStep; t < 40.0; t += kStep) {
    const Rigid3d now = flight.WorldFromBody(t);
    const Eigen::Vector3d velocity = flight.Velocity(t);
    EXPECT_GT(velocity.norm(), 0.4);
    EXPECT_LT(velocity.norm(), 1.8);
    EXPECT_LT((velocity - velocity_before).norm() / kStep, 4.0);                 // metres a second squared
    EXPECT_LT(LogSo3((before.Inverse() * now).rotation()).norm() / kStep, 1.0);  // radians a second
    EXPECT_NEAR(((now.translation() - before.translation()) / kStep - velocity).norm(), 0.0, 0.02);
    before = now;
    velocity_before = velocity;
  }
}

TEST_P(FlightOfSeed, SessionsStartApartAndComeWhereTheOthersWere) {
  const Flight first = Fly(0);
  const Flight second = Fly(1);
  EXPECT_GT((first.WorldFromBody(0.0).translation() - second.WorldFromBody(0.0).translation()).norm(), 3.0);
  int shared_views = 0;
  for (double a = 0.0; a < 20.0; a += 0.25) {
    for (double b = 0.0; b < 20.0; b += 0.25) {
      const Rigid3d between = first.WorldFromBody(a).Inverse() * second.WorldFromBody(b);
      if (between.translation().norm() < 1.5 && LogSo3(between.rotation()).norm() < 0.5) ++shared_views;
    }
  }
  EXPECT_GT(shared_views, 20);
}

INSTANTIATE_TEST_SUITE_P(Seeds, FlightOfSeed, testing::Range<std::uint64_t>(0, 6));

}  // namespace
}  // namespace pangaea
