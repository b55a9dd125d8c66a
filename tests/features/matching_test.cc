#include "common/features/matching.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace pangaea {
namespace {

Descriptor RandomDescriptor(std::mt19937_64& random) {
  Descriptor descriptor;
  for (std::uint64_t& word : descriptor.words) word = random();
  return descriptor;
}

Descriptor WithFlippedBits(Descriptor descriptor, int bits) {
  for (int i = 0; i < bits; ++i) descriptor.words[static_cast<std::size_t>(i % 4)] ^= 1ULL << (i / 4);
  return descriptor;
}

Keypoint MakeKeypoint(float u, float v, int octave = 0, int angle = 0) {
  Keypoint keypoint;
  keypoint.u = u;
  keypoint.v = v;
  keypoint.octave = static_cast<std::uint8_t>(octave);
  keypoint.angle = static_cast<std::uint8_t>(angle);
  return keypoint;
}

std::vector<Keypoint> RandomKeypoints(int count, std::mt19937_64& random) {
  std::uniform_real_distribution<float> u(-20.0F, 760.0F), v(0.0F, 480.0F);
  std::vector<Keypoint> keypoints;
  for (int i = 0; i < count; ++i) {
    const float column = u(random);
    keypoints.push_back(MakeKeypoint(column, v(random), i % kOctaves));
  }
  return keypoints;
}

TEST(FeatureGrid, FindsWhatALoopOverAllKeypointsFinds) {
  std::mt19937_64 random(1);
  const std::vector<Keypoint> keypoints = RandomKeypoints(800, random);
  const FeatureGrid grid(keypoints);
  std::uniform_real_distribution<float> coordinate(-100.0F, 900.0F), radius(0.0F, 120.0F);
  for (int trial = 0; trial < 200; ++trial) {
    const float u = coordinate(random), v = coordinate(random), r = radius(random);
    std::set<std::uint32_t> found, expected;
    grid.ForEachInWindow(u, v, r, 2, 5, [&](std::uint32_t i) { EXPECT_TRUE(found.insert(i).second); });
    for (std::uint32_t i = 0; i < keypoints.size(); ++i) {
      const Keypoint& k = keypoints[i];
      if (k.u >= u - r && k.u <= u + r && k.v >= v - r && k.v <= v + r && k.octave >= 2 && k.octave <= 5) {
        expected.insert(i);
      }
    }
    EXPECT_EQ(found, expected);
  }
}

TEST(FeatureGrid, OfNoKeypointsFindsNone) {
  const FeatureGrid grid;
  grid.ForEachInWindow(0.0F, 0.0F, 1e9F, 0, kOctaves, [](std::uint32_t) { ADD_FAILURE(); });
}

TEST(FeatureGrid, AcceptsWindowsFarOutsideTheImage) {
  const std::vector<Keypoint> keypoints = {MakeKeypoint(10.0F, 10.0F)};
  int found = 0;
  FeatureGrid(keypoints).ForEachInWindow(-1e30F, 1e30F, 5.0F, 0, kOctaves, [&](std::uint32_t) { ++found; });
  EXPECT_EQ(found, 0);
}

TEST(MatchByProjection, TakesTheNearestDescriptorInTheWindow) {
  std::mt19937_64 random(2);
  const Descriptor wanted = RandomDescriptor(random);
  const std::vector<Keypoint> keypoints = {MakeKeypoint(100, 100), MakeKeypoint(104, 100), MakeKeypoint(300, 100)};
  const std::vector<Descriptor> descriptors = {RandomDescriptor(random), WithFlippedBits(wanted, 20), wanted};
  const ProjectionQuery query{.u = 101, .v = 101, .radius = 10, .descriptor = wanted};
  const auto matches = MatchByProjection(std::span(&query, 1), FeatureGrid(keypoints), descriptors);
  EXPECT_EQ(matches, (std::vector<Match>{{0, 1, 20}}));
}

TEST(MatchByProjection, RefusesTwoPlacesThatLookAlike) {
  std::mt19937_64 random(3);
  const Descriptor wanted = RandomDescriptor(random);
  const std::vector<Keypoint> keypoints = {MakeKeypoint(100, 100), MakeKeypoint(108, 100)};
  const std::vector<Descriptor> descriptors = {WithFlippedBits(wanted, 20), WithFlippedBits(wanted, 22)};
  const ProjectionQuery query{.u = 100, .v = 100, .radius = 10, .descriptor = wanted};
  EXPECT_TRUE(MatchByProjection(std::span(&query, 1), FeatureGrid(keypoints), descriptors).empty());
}

TEST(MatchByProjection, ACornerSeenInTwoOctavesIsNoSecondPlace) {
  std::mt19937_64 random(4);
  const Descriptor wanted = RandomDescriptor(random);
  const std::vector<Keypoint> keypoints = {MakeKeypoint(100, 100, 0), MakeKeypoint(101, 100, 1)};
  const std::vector<Descriptor> descriptors = {WithFlippedBits(wanted, 20), WithFlippedBits(wanted, 22)};
  const ProjectionQuery query{.u = 100, .v = 100, .radius = 10, .descriptor = wanted};
  EXPECT_EQ(MatchByProjection(std::span(&query, 1), FeatureGrid(keypoints), descriptors).size(), 1U);
}

TEST(MatchByProjection, OfTwoQueriesForOneKeypointTheNearerKeepsIt) {
  std::mt19937_64 random(5);
  const Descriptor wanted = RandomDescriptor(random);
  const std::vector<Keypoint> keypoints = {MakeKeypoint(100, 100)};
  std::vector<ProjectionQuery> queries(2, {.u = 100, .v = 100, .radius = 10});
  queries[0].descriptor = WithFlippedBits(wanted, 9);
  queries[1].descriptor = WithFlippedBits(wanted, 5);
  const auto matches = MatchByProjection(queries, FeatureGrid(keypoints), std::span(&wanted, 1));
  EXPECT_EQ(matches, (std::vector<Match>{{1, 0, 5}}));
}

TEST(MatchByProjection, AKeypointWithOtherDepthIsPassedOver) {
  std::mt19937_64 random(6);
  const Descriptor wanted = RandomDescriptor(random);
  std::vector<Keypoint> keypoints = {MakeKeypoint(100, 100)};
  keypoints[0].u_right = 60.0F;
  ProjectionQuery query{.u = 100, .v = 100, .u_right = 90.0F, .radius = 10, .descriptor = wanted};
  EXPECT_TRUE(MatchByProjection(std::span(&query, 1), FeatureGrid(keypoints), std::span(&wanted, 1)).empty());
  query.u_right = 65.0F;
  EXPECT_EQ(MatchByProjection(std::span(&query, 1), FeatureGrid(keypoints), std::span(&wanted, 1)).size(), 1U);
}

TEST(MatchBruteForce, FindsAPermutationThroughNoise) {
  std::mt19937_64 random(7);
  std::vector<Descriptor> train, queries;
  for (int i = 0; i < 300; ++i) train.push_back(RandomDescriptor(random));
  for (std::size_t i = 0; i < train.size(); ++i) queries.push_back(WithFlippedBits(train[(7 * i) % 300], 30));
  const auto matches = MatchBruteForce(queries, train);
  ASSERT_EQ(matches.size(), queries.size());
  for (const Match& match : matches) EXPECT_EQ(match.train, (7 * match.query) % 300);
}

TEST(MatchBruteForce, RefusesWhatIsTooFarOrNotMutual) {
  std::mt19937_64 random(8);
  const Descriptor wanted = RandomDescriptor(random);
  const std::vector<Descriptor> queries = {WithFlippedBits(wanted, 10), WithFlippedBits(wanted, 5)};
  EXPECT_EQ(MatchBruteForce(queries, std::span(&wanted, 1)), (std::vector<Match>{{1, 0, 5}}));
  EXPECT_TRUE(MatchBruteForce(queries, std::span(&wanted, 1), {.max_distance = 4}).empty());
  EXPECT_EQ(MatchBruteForce(queries, std::span(&wanted, 1), {.unique = false}).size(), 2U);
  EXPECT_TRUE(MatchBruteForce(queries, {}).empty());
}

TEST(FilterByRotation, KeepsTheCommonTurnAcrossTheWrap) {
  std::mt19937_64 random(9);
  std::vector<Keypoint> before, after;
  std::vector<Match> matches;
  for (std::uint32_t i = 0; i < 50; ++i) {
    const int angle = static_cast<int>(random() % 256);
    const int turn = i < 40 ? static_cast<int>(i % 11) - 5 : 100;  // around 0: the differences wrap
    before.push_back(MakeKeypoint(0, 0, 0, angle));
    after.push_back(MakeKeypoint(0, 0, 0, angle + turn));
    matches.push_back({i, i, 0});
  }
  const auto kept = FilterByRotation(matches, before, after);
  ASSERT_EQ(kept.size(), 40U);
  EXPECT_EQ(kept.back().query, 39U);
}

}  // namespace
}  // namespace pangaea
