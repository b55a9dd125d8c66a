#include "server/map_comparison/map_comparison.h"

#include <gtest/gtest.h>

#include <vector>

#include "server/fusion/welding.h"
#include "server/map_comparison/map_sample.h"
#include "server/map_comparison/point_grid.h"
#include "tests/server/strewn_places.h"
#include "tests/server/surveyed_world.h"

namespace pangaea {
namespace {

MapComparison Compare(const std::vector<Thing>& annas, const std::vector<Thing>& berts) {
  Atlas atlas;
  Survey(kAnna, annas, Rigid3d(), atlas);
  Survey(kBert, berts, kWhereBertBegan, atlas);
  return CompareMaps(atlas, M(1, kBert), M(1), {});
}

TEST(MapComparison, APlaceWhereThreeOfAHundredThingsLookAsBeforeIsRecognised) {
  Strewer strewer(1);
  const auto before = strewer.Things(1500);
  Atlas atlas;
  Survey(kAnna, before, Rigid3d(), atlas);
  Survey(kBert, Repainted(before, 45, strewer), kWhereBertBegan, atlas);
  const MapComparison comparison = CompareMaps(atlas, M(1, kBert), M(1), {});
  ASSERT_EQ(comparison.outcome, MapComparisonOutcome::kOnePlace) << Describe(comparison);
  EXPECT_EQ(comparison.pairs, 45u);
  EXPECT_EQ(comparison.rival_support, 0u);
  ASSERT_TRUE(comparison.match);
  const PlaceMatch& match = *comparison.match;
  EXPECT_EQ(match.query.session, kBert);
  EXPECT_EQ(match.candidate.session, kAnna);
  EXPECT_TRUE(match.metric);
  for (const auto& [berts, annas] : match.landmarks) EXPECT_EQ(berts.counter, annas.counter);
  // Both cameras of the match stood at the same place of the world.
  const Rigid3d bert_from_world = atlas.FindKeyframe(match.query)->camera_from_map * kWhereBertBegan;
  const Rigid3d anna_from_world = atlas.FindKeyframe(match.candidate)->camera_from_map;
  const Similarity3d truth(anna_from_world * bert_from_world.Inverse());
  EXPECT_LT((match.candidate_from_query.translation() - truth.translation()).norm(), 1e-6);
  EXPECT_LT(match.candidate_from_query.rotation().angularDistance(truth.rotation()), 1e-7);
  EXPECT_EQ(match.candidate_from_query.scale(), 1.0);
  ASSERT_TRUE(match.evidence.compared);
  EXPECT_EQ(match.evidence.inliers, 45u);
  EXPECT_GT(match.evidence.compared->surface_share, 0.99);
}

TEST(MapComparison, WallsAloneDoNotMakeAPlace) {
  Strewer strewer(2);
  const auto before = strewer.Things(1500);
  EXPECT_EQ(Compare(before, Repainted(before, 0, strewer)).outcome, MapComparisonOutcome::kNoMotion);
}

TEST(MapComparison, ThingsOfTwoPlacesThatStandAlikeAmongOtherWallsDoNotMakeThemOne) {
  Strewer strewer(3);
  auto there = strewer.Things(1500);
  const auto here = there;
  for (std::size_t i = 45; i < there.size(); ++i) there[i].position = strewer.Position();
  for (std::size_t i = 45; i < there.size(); ++i) there[i].look = strewer.Look();
  const MapComparison comparison = Compare(here, there);
  EXPECT_EQ(comparison.outcome, MapComparisonOutcome::kSurfacesDisagree) << Describe(comparison);
  EXPECT_FALSE(comparison.match);
}

TEST(MapComparison, OneThingThatStandsInBothPlacesDoesNotMakeThemOne) {
  Strewer strewer(4);
  auto here = strewer.Things(1500);
  // A machine with a hundred corners, nine metres wide; a cell is six.
  for (int i = 0; i < 100; ++i) here[i].position = Eigen::Vector3d(5.0, 5.0, 17.0) + 0.15 * strewer.Position();
  const auto there = Repainted(here, 100, strewer);
  const MapComparison comparison = Compare(here, there);
  EXPECT_EQ(comparison.outcome, MapComparisonOutcome::kNarrow) << Describe(comparison);
  EXPECT_LE(comparison.support, 2 * comparison.cells);
  EXPECT_EQ(comparison.pairs, 100u);
}

TEST(MapComparison, AHandfulOfThingsIsNotEnough) {
  Strewer strewer(11);
  const auto before = strewer.Things(1500);
  const MapComparison comparison = Compare(before, Repainted(before, 20, strewer));
  EXPECT_EQ(comparison.outcome, MapComparisonOutcome::kFewPairs) << Describe(comparison);
}

TEST(MapComparison, OfALargeMapAPartIsComparedSpreadOverAllOfIt) {
  Strewer strewer(12);
  Atlas atlas;
  Survey(kAnna, strewer.Things(1000), Rigid3d(), atlas);
  MapComparisonOptions options;
  options.max_landmarks = 100;
  const MapSample sample = SampleMap(atlas, M(1), options);
  ASSERT_EQ(sample.landmarks.size(), 100u);
  for (std::uint32_t i = 0; i < 100; ++i) EXPECT_EQ(sample.landmarks[i], L(10 * i + 1));
}

TEST(MapComparison, WhereHalfOfWhatStayedSaysOneMotionAndHalfAnotherNeitherIsBelieved) {
  Strewer strewer(5);
  const auto before = strewer.Things(1500);
  auto after = Repainted(before, 90, strewer);
  for (int i = 0; i < 45; ++i) after[i].position += Eigen::Vector3d(3.0, 0.0, 0.0);
  const MapComparison comparison = Compare(before, after);
  EXPECT_EQ(comparison.outcome, MapComparisonOutcome::kAmbiguous) << Describe(comparison);
}

TEST(MapComparison, PlacesThatOverlapByHalfAreNotOneAsAWhole) {
  Strewer strewer(6);
  const auto common = strewer.Things(750, -15.0, 15.0);
  auto here = common;
  auto there = Repainted(common, 60, strewer);
  for (const Thing& thing : strewer.Things(750, -45.0, -15.0)) here.push_back(thing);
  for (const Thing& thing : strewer.Things(750, 15.0, 45.0)) there.push_back(thing);
  const MapComparison comparison = Compare(here, there);
  EXPECT_EQ(comparison.outcome, MapComparisonOutcome::kSmallOverlap) << Describe(comparison);
}

TEST(MapComparison, WithoutScaleOrWithAMapThatIsGoneNothingIsCompared) {
  Strewer strewer(7);
  const auto things = strewer.Things(500);
  Atlas atlas;
  Survey(kAnna, things, Rigid3d(), atlas);
  Survey(kBert, things, kWhereBertBegan, atlas, false);
  const auto outcome = [&](MapId a, MapId b) { return CompareMaps(atlas, a, b, {}).outcome; };
  EXPECT_EQ(outcome(M(1, kBert), M(1)), MapComparisonOutcome::kNotComparable);
  EXPECT_EQ(outcome(M(7), M(1)), MapComparisonOutcome::kNotComparable);
  EXPECT_EQ(outcome(M(1), M(1)), MapComparisonOutcome::kNotComparable);
}

TEST(MapComparison, TheSameMapsGiveTheSameAnswer) {
  const auto once = [] {
    Strewer strewer(8);
    const auto before = strewer.Things(1500);
    return Compare(before, Repainted(before, 40, strewer));
  };
  const MapComparison first = once();
  const MapComparison second = once();
  ASSERT_TRUE(first.match && second.match);
  EXPECT_EQ(first.match->candidate_from_query.translation(), second.match->candidate_from_query.translation());
  EXPECT_EQ(first.match->landmarks, second.match->landmarks);
}

// With cameras that see what is before them, keypoints with noise, and maps that are a little wrong.
TEST(MapComparison, ARoomThatWasRearrangedBetweenTwoSessionsBecomesOneMap) {
  testing::SurveyedWorld world(9);
  world.Fly(kAnna, testing::CirclePoses(0, 39, 40), {});
  world.Rearrange(0.06);
  world.Fly(kBert, testing::CirclePoses(3, 42, 40), {.map_from_world = Similarity3d(kWhereBertBegan)});
  const MapComparison comparison = CompareMaps(world.atlas, M(1, kBert), M(1), {});
  ASSERT_TRUE(comparison.match) << Describe(comparison);
  const Rigid3d truth = world.TrueCameraFromWorld(comparison.match->candidate) *
                        world.TrueCameraFromWorld(comparison.match->query).Inverse();
  EXPECT_LT((comparison.match->candidate_from_query.translation() - truth.translation()).norm(), 0.03);
  const WeldingOutcome welded = PlanWelding(world.atlas, *comparison.match, {}, {});
  ASSERT_TRUE(welded) << Describe(welded.error());
  EXPECT_TRUE(welded->is_merge());
}

TEST(PointGrid, FindsThePointsWithinTheRadiusAndNoOthers) {
  Strewer strewer(10);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 2000; ++i) points.push_back(strewer.Position());
  const PointGrid grid(points, 2.5);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d center = strewer.Position();
    std::size_t expected = 0;
    for (const Eigen::Vector3d& point : points) expected += (point - center).norm() <= 2.5 ? 1 : 0;
    std::size_t found = 0;
    grid.ForEachNear(center, [&](std::uint32_t) { ++found; });
    EXPECT_EQ(found, expected);
  }
}

TEST(PointGrid, PointsWithoutBoundsAreCellsLikeOthers) {
  const double huge = 1e300;
  EXPECT_EQ(CellOf({huge, -huge, 0.0}, 0.1), CellOf({2.0 * huge, -2.0 * huge, 0.0}, 0.1));
  EXPECT_NE(CellOf({-0.01, 0.0, 0.0}, 1.0), CellOf({0.01, 0.0, 0.0}, 1.0));
  const std::vector<Eigen::Vector3d> points(3, Eigen::Vector3d(huge, huge, huge));
  std::size_t found = 0;
  PointGrid(points, 0.1).ForEachNear(points[0], [&](std::uint32_t) { ++found; });
  EXPECT_EQ(found, 3u) << "each once";
  (void)CellOf({1.0, 0.0, 0.0}, 0.0);
  (void)CellOf({0.0, 0.0, 0.0}, 0.0);
}

}  // namespace
}  // namespace pangaea
