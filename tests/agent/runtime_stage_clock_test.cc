#include <gtest/gtest.h>

#include <chrono>

#include "agent/runtime/stage_clock.h"

namespace pangaea {
namespace {

// Keeps the processor busy: stages are measured by the wall clock.
void Work(double milliseconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double, std::milli>(milliseconds);
  while (std::chrono::steady_clock::now() < end) continue;
}

TEST(StageClock, CountsEveryRunOfAStage) {
  StageClock clock;
  for (int i = 0; i < 3; ++i) const StageScope scope(clock, "tracking");
  const auto statistics = clock.Statistics();
  ASSERT_EQ(statistics.size(), 1U);
  EXPECT_EQ(statistics.at("tracking").count, 3U);
  EXPECT_LE(statistics.at("tracking").median_ms, statistics.at("tracking").p95_ms);
}

TEST(StageClock, AStageIsChargedForTheStagesInsideIt) {
  StageClock clock;
  {
    const StageScope outer(clock, "tracking");
    const StageScope inner(clock, "tracking.pose");
    Work(5.0);
  }
  const auto statistics = clock.Statistics();
  EXPECT_GE(statistics.at("tracking.pose").mean_ms, 5.0);
  EXPECT_GE(statistics.at("tracking").mean_ms, statistics.at("tracking.pose").mean_ms);
}

TEST(StageClock, DecodingIsChargedToNoStageAroundIt) {
  StageClock clock;
  // The median: what else runs on the machine may hold up any single one.
  for (int i = 0; i < 20; ++i) {
    const StageScope outer(clock, "local_mapping");
    const StageScope middle(clock, "keyframe.stereo");
    const StageScope decode(clock, StageClock::kDecode);
    Work(2.0);
  }
  const auto statistics = clock.Statistics();
  EXPECT_GE(statistics.at("decode").median_ms, 2.0);
  EXPECT_LT(statistics.at("local_mapping").median_ms, statistics.at("decode").median_ms);
  EXPECT_LT(statistics.at("keyframe.stereo").median_ms, statistics.at("decode").median_ms);
}

TEST(StageClock, TwoClocksAddUpToOne) {
  StageClock one;
  StageClock other;
  { const StageScope scope(one, "tracking"); }
  { const StageScope scope(other, "tracking"); }
  { const StageScope scope(other, "local_mapping"); }
  one.Add(other);
  EXPECT_EQ(one.Statistics().at("tracking").count, 2U);
  EXPECT_EQ(one.Statistics().at("local_mapping").count, 1U);
}

TEST(StageClock, MedianMeanAndPercentileAreThoseOfTheDurations) {
  StageClock clock;
  for (int i = 0; i < 9; ++i) const StageScope scope(clock, "stage");
  {
    const StageScope scope(clock, "stage");
    Work(50.0);
  }
  const StageStatistics statistics = clock.Statistics().at("stage");
  EXPECT_LT(statistics.median_ms, statistics.mean_ms);
  EXPECT_GE(statistics.p95_ms, 50.0);
  EXPECT_GE(statistics.mean_ms, 5.0);
}

}  // namespace
}  // namespace pangaea
