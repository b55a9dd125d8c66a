#include <gtest/gtest.h>

#include <algorithm>

#include "common/map/consistency.h"
#include "common/map/map_edit.h"
#include "server/optimization/global_bundle_adjustment.h"
#include "server/optimization/median_depth.h"
#include "tests/server/optimization_ring.h"

namespace pangaea::testing {
namespace {

// The ring with poses and points disturbed, and after its adjustment.
struct AdjustedRing {
  explicit AdjustedRing(const RingOptions& ring_options, const GlobalBundleOptions& options = {})
      : ring(MakeRing(ring_options)),
        disturbed(Corrected(ring.atlas, Disturb(ring, 5, 0.05, 0.01, 0.1))),
        bundle(AdjustMap(disturbed, ring.map, options, {})) {
    if (bundle) adjusted = Corrected(disturbed, bundle->correction);
  }
  Ring ring;
  Atlas disturbed;
  std::optional<GlobalBundle> bundle;
  Atlas adjusted;
};

TEST(GlobalBundleAdjustment, PutsAStereoMapWhereItWasSeen) {
  const AdjustedRing world({.stereo = true});
  ASSERT_TRUE(world.bundle);
  EXPECT_GT(PositionError(world.ring, world.disturbed), 0.03);
  // Pixels are rounded to 1 / 32.
  EXPECT_LT(PositionError(world.ring, world.adjusted), 0.005);
  EXPECT_EQ(world.bundle->outliers, 0U);
  EXPECT_TRUE(world.bundle->removals.empty());
  EXPECT_LT(world.bundle->final_cost, 1e-3 * static_cast<double>(world.bundle->observations));
  double error = 0.0;
  for (const auto& [id, truth] : world.ring.point_in_map) {
    error += (world.adjusted.FindLandmark(id)->point_in_map - truth).norm();
  }
  EXPECT_LT(error / static_cast<double>(world.ring.point_in_map.size()), 0.01);
}

TEST(GlobalBundleAdjustment, IterativeAndDirectSolversAgree) {
  const AdjustedRing direct({.stereo = true, .noise = 0.5});
  const AdjustedRing iterative({.stereo = true, .noise = 0.5}, {.direct_pairs = 0});
  ASSERT_TRUE(direct.bundle && iterative.bundle);
  EXPECT_NEAR(direct.bundle->final_cost, iterative.bundle->final_cost, 1e-3 * direct.bundle->final_cost);
}

TEST(GlobalBundleAdjustment, TheRootStaysBitForBit) {
  const AdjustedRing world({.stereo = true, .noise = 0.5});
  ASSERT_TRUE(world.bundle);
  const KeyframeId root = world.ring.keyframes.front();
  EXPECT_EQ(world.adjusted.FindKeyframe(root)->camera_from_map.translation(),
            world.disturbed.FindKeyframe(root)->camera_from_map.translation());
  EXPECT_NE(world.adjusted.FindKeyframe(root)->corrected_at, 0U) << "and is the server's from now on";
}

TEST(GlobalBundleAdjustment, RemovesWhatContradictsTheMap) {
  AdjustedRing world({.stereo = true, .noise = 0.05, .outliers = 0.03});
  ASSERT_TRUE(world.bundle);
  EXPECT_LT(PositionError(world.ring, world.adjusted), 0.6 * PositionError(world.ring, world.disturbed));
  EXPECT_GT(world.bundle->outliers, world.bundle->observations / 50);
  EXPECT_LT(world.bundle->outliers, world.bundle->observations / 10);
  EXPECT_FALSE(world.bundle->removals.empty());
  for (const MapEdit& edit : world.bundle->removals) ASSERT_TRUE(Apply(edit, world.adjusted));
  EXPECT_TRUE(CheckConsistency(world.adjusted).empty());
}

TEST(GlobalBundleAdjustment, AMonocularMapGetsItsShapeBackAndKeepsItsMedianDepth) {
  const AdjustedRing world({.stereo = false});
  ASSERT_TRUE(world.bundle);
  EXPECT_NEAR(MedianDepth(world.adjusted, world.ring.map), MedianDepth(world.disturbed, world.ring.map), 0.03);
  EXPECT_LT(PositionError(world.ring, world.adjusted), 0.3 * PositionError(world.ring, world.disturbed));
}

TEST(GlobalBundleAdjustment, ScaleDriftOfAMonocularMapShowsInTheScalesOfItsKeyframes) {
  const Ring ring = MakeRing({.stereo = false, .closed = true});
  const auto cameras = Drift(ring, Similarity3d(1.002, Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.0}));
  const Atlas drifted = Corrected(ring.atlas, PlaceAt(ring.atlas, ring.map, cameras));
  const auto bundle = AdjustMap(drifted, ring.map, {.iterations = 50, .cost_tolerance = 1e-8}, {});
  ASSERT_TRUE(bundle);
  // What was made smaller and smaller has to grow more and more.
  const auto& keyframes = bundle->correction.keyframes;
  EXPECT_NEAR(keyframes.back().scale / keyframes.front().scale, cameras.at(keyframes.back().id).scale(), 0.02);
}

TEST(GlobalBundleAdjustment, AKeyframeThatSeesNothingFollowsItsParent) {
  const Ring ring = MakeRing({.stereo = true});
  Atlas disturbed = Corrected(ring.atlas, Disturb(ring, 5, 0.05, 0.01, 0.1));
  const KeyframeId blind = {1, 99};
  const KeyframeId parent = ring.keyframes[20];
  const Rigid3d from_parent(Eigen::Quaterniond::Identity(), {0.1, 0.2, 0.3});
  ASSERT_TRUE(
      Apply(AddKeyframe{blind, ring.map, parent, from_parent, disturbed.FindKeyframe(parent)->data}, disturbed));
  const auto bundle = AdjustMap(disturbed, ring.map, {}, {});
  ASSERT_TRUE(bundle);
  const Atlas adjusted = Corrected(disturbed, bundle->correction);
  const Rigid3d after =
      adjusted.FindKeyframe(blind)->camera_from_map * adjusted.FindKeyframe(parent)->camera_from_map.Inverse();
  EXPECT_LT((after * from_parent.Inverse()).Log().norm(), 1e-9);
}

TEST(GlobalBundleAdjustment, AStopOrTooLittleToAdjustGivesNothing) {
  const Ring ring = MakeRing({.keyframes = 20, .landmarks = 50});
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(AdjustMap(ring.atlas, ring.map, {}, stop.get_token()));
  EXPECT_FALSE(AdjustMap(ring.atlas, {1, 2}, {}, {}));
  EXPECT_FALSE(AdjustMap(MakeRing({.keyframes = 20, .landmarks = 0}).atlas, ring.map, {}, {}));
}

TEST(GlobalBundleAdjustment, OutOfTimeItGivesWhatItHas) {
  const Ring ring = MakeRing({.stereo = true});
  const Atlas disturbed = Corrected(ring.atlas, Disturb(ring, 5, 0.05, 0.01, 0.1));
  const auto bundle = AdjustMap(disturbed, ring.map, {}, {}, [] { return true; });
  ASSERT_TRUE(bundle);
  EXPECT_EQ(bundle->iterations, 2);  // one of each phase
  EXPECT_LT(PositionError(ring, Corrected(disturbed, bundle->correction)), PositionError(ring, disturbed));
}

TEST(GlobalBundleOptions, OutOfRangeIsRefused) {
  EXPECT_TRUE(GlobalBundleOptions{}.Check());
  EXPECT_FALSE(GlobalBundleOptions{.noise = {.pixel_sigma = 0.0}}.Check());
  EXPECT_FALSE(GlobalBundleOptions{.noise = {.max_depth_baselines = 0.0}}.Check());
  EXPECT_FALSE(GlobalBundleOptions{.iterations = 0}.Check());
  EXPECT_FALSE(GlobalBundleOptions{.iterations_without_outliers = -1}.Check());
  EXPECT_FALSE(GlobalBundleOptions{.cost_tolerance = -1.0}.Check());
  EXPECT_FALSE(GlobalBundleOptions{.threads = 0}.Check());
  EXPECT_FALSE(GlobalBundleOptions{.max_seconds = -1.0}.Check());
}

}  // namespace
}  // namespace pangaea::testing
