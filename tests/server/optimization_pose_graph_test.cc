#include <gtest/gtest.h>

#include "common/map/map_edit.h"
#include "server/optimization/essential_graph.h"
#include "server/optimization/median_depth.h"
#include "server/optimization/pose_graph.h"
#include "server/optimization/pose_graph_cost.h"
#include "tests/estimation/synthetic_world.h"
#include "tests/server/optimization_ring.h"

namespace pangaea::testing {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Similarity3d RandomSimilarity(Random& random, double size, double log_scale) {
  const Rigid3d rigid = Perturbed(random, Rigid3d(), size, size);
  return Similarity3d(std::exp(Uniform(random, -log_scale, log_scale)), rigid.rotation(), rigid.translation());
}

void CheckJacobians(std::uint64_t seed, bool with_scale) {
  Random random(seed);
  const int size = with_scale ? 7 : 6;
  const SimilarityManifold manifold(with_scale);
  const double log_scale = with_scale ? 0.5 : 0.0;
  const std::array<Similarity3d, 2> cameras = {RandomSimilarity(random, 2.0, log_scale),
                                               RandomSimilarity(random, 2.0, log_scale)};
  // Near the truth, far from it, and at it.
  const double error = seed % 3 == 0 ? 0.0 : 0.8 * static_cast<double>(seed % 3);
  const Similarity3d measured = RandomSimilarity(random, error, error * log_scale) * cameras[1] * cameras[0].Inverse();
  const auto cost = MakePoseGraphCost(measured, {.translation = 0.7, .rotation = 1.3, .scale = 2.1}, with_scale);
  ASSERT_EQ(cost->num_residuals(), size);
  const std::array<SimilarityParameters, 2> x = {ToParameters(cameras[0]), ToParameters(cameras[1])};
  const auto evaluate = [&](int block, const SimilarityParameters& at) {
    const double* parameters[] = {block == 0 ? at.data() : x[0].data(), block == 1 ? at.data() : x[1].data()};
    Eigen::VectorXd residual(size);
    cost->Evaluate(parameters, residual.data(), nullptr);
    return residual;
  };
  std::array<RowMajor, 2> analytic = {RowMajor(size, 8), RowMajor(size, 8)};
  double* jacobians[] = {analytic[0].data(), analytic[1].data()};
  const double* parameters[] = {x[0].data(), x[1].data()};
  Eigen::VectorXd residual(size);
  cost->Evaluate(parameters, residual.data(), jacobians);
  RowMajor plus(8, size);
  manifold.PlusJacobian(x[0].data(), plus.data());
  const double h = 1e-6;
  for (int block = 0; block < 2; ++block) {
    for (int k = 0; k < size; ++k) {
      SimilarityParameters above;
      SimilarityParameters below;
      const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(size, k);
      const Eigen::VectorXd back = -step;
      manifold.Plus(x[block].data(), step.data(), above.data());
      manifold.Plus(x[block].data(), back.data(), below.data());
      const Eigen::VectorXd numeric = (evaluate(block, above) - evaluate(block, below)) / (2.0 * h);
      const Eigen::VectorXd column = (analytic[block] * plus).col(k);
      EXPECT_LT((column - numeric).norm(), 1e-6 * (1.0 + numeric.norm())) << seed << " block " << block << " k " << k;
    }
  }
}

TEST(PoseGraphCost, AnalyticJacobiansAreTheNumericOnes) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    CheckJacobians(seed, false);
    CheckJacobians(seed, true);
  }
}

TEST(SimilarityManifold, MinusTakesBackWhatPlusAdded) {
  Random random(3);
  for (const bool scale_is_free : {false, true}) {
    const SimilarityManifold manifold(scale_is_free);
    const SimilarityParameters x = ToParameters(RandomSimilarity(random, 2.0, 0.5));
    Eigen::VectorXd step(manifold.TangentSize());
    for (double& value : step) value = Uniform(random, -0.5, 0.5);
    SimilarityParameters y;
    manifold.Plus(x.data(), step.data(), y.data());
    Eigen::VectorXd difference(manifold.TangentSize());
    manifold.Minus(y.data(), x.data(), difference.data());
    EXPECT_LT((difference - step).norm(), 1e-12);
    EXPECT_EQ(x[7] == y[7], !scale_is_free);
  }
}

PoseGraphOptions FewLandmarks() { return {.strong_covisibility = 30}; }

// Odometry that errs by the same at each step; then the last keyframes are recognised to be where they are.
struct DriftedRing {
  explicit DriftedRing(const RingOptions& options, const Similarity3d& step_error) : ring(MakeRing(options)) {
    const auto cameras = Drift(ring, step_error);
    before = Corrected(ring.atlas, PlaceAt(ring.atlas, ring.map, cameras));
    std::map<KeyframeId, Similarity3d> seam;
    for (std::size_t i = 0; i < 3; ++i) held[ring.keyframes[i]] = 1.0;
    for (std::size_t i = ring.keyframes.size() - 3; i < ring.keyframes.size(); ++i) {
      const KeyframeId id = ring.keyframes[i];
      held[id] = cameras.at(id).scale();
      seam[id] = Similarity3d(1.0 / held[id], ring.camera_from_map.at(id).rotation(),
                              ring.camera_from_map.at(id).translation() / held[id]);
    }
    after = Corrected(before, PlaceAt(before, ring.map, seam));
  }
  Ring ring;
  Atlas before;
  Atlas after;
  std::map<KeyframeId, double> held;
};

// Turns that are too short by the same angle, and below lengths that grow by the same factor: spread evenly, such
// errors vanish, and the least squares are at the truth.
TEST(PoseGraph, TakesBackTheDriftOfAMetricLoop) {
  const DriftedRing world({.stereo = true}, Similarity3d(1.0, ExpSo3({0.0, 0.005, 0.0}), {0.0, 0.0, 0.0}));
  const auto result = OptimizePoseGraph(world.before, world.after, world.ring.map, world.held, FewLandmarks(), {});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->correction.keyframes.size(), world.ring.keyframes.size() - world.held.size());
  const Atlas corrected = Corrected(world.after, result->correction);
  const double drift = PositionError(world.ring, world.before);
  EXPECT_GT(drift, 0.3);
  EXPECT_LT(PositionError(world.ring, corrected), 0.05 * drift);
  for (const CorrectedKeyframe& keyframe : result->correction.keyframes) EXPECT_EQ(keyframe.scale, 1.0);
}

TEST(PoseGraph, TakesBackTheDriftInScaleOfAMonocularLoopAndLandmarksFollow) {
  const DriftedRing world({.stereo = false}, Similarity3d(1.01, Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.0}));
  const auto result = OptimizePoseGraph(world.before, world.after, world.ring.map, world.held, FewLandmarks(), {});
  ASSERT_TRUE(result);
  const Atlas corrected = Corrected(world.after, result->correction);
  const double drift = PositionError(world.ring, world.before);
  EXPECT_GT(drift, 0.3);
  EXPECT_LT(PositionError(world.ring, corrected), 0.05 * drift);
  double landmark_drift = 0.0;
  double landmark_error = 0.0;
  for (const auto& [id, truth] : world.ring.point_in_map) {
    landmark_drift += (world.before.FindLandmark(id)->point_in_map - truth).norm();
    landmark_error += (corrected.FindLandmark(id)->point_in_map - truth).norm();
  }
  EXPECT_LT(landmark_error, 0.05 * landmark_drift);
}

TEST(PoseGraph, SpreadsAnyDriftSoThatLittleOfItIsLeft) {
  const Eigen::Quaterniond turn = ExpSo3({0.001, 0.003, -0.002});
  for (const bool stereo : {false, true}) {
    const DriftedRing world({.stereo = stereo}, Similarity3d(stereo ? 1.0 : 1.01, turn, {0.01, 0.005, -0.01}));
    const auto result = OptimizePoseGraph(world.before, world.after, world.ring.map, world.held, FewLandmarks(), {});
    ASSERT_TRUE(result);
    EXPECT_LT(result->final_cost, 0.2 * result->initial_cost);
    const Atlas corrected = Corrected(world.after, result->correction);
    EXPECT_LT(PositionError(world.ring, corrected), 0.4 * PositionError(world.ring, world.before)) << stereo;
  }
}

TEST(PoseGraph, WhatIsHeldStaysBitForBit) {
  const DriftedRing world({.stereo = true}, Similarity3d(Rigid3d::Exp(Vector6d::Constant(0.003))));
  const auto result = OptimizePoseGraph(world.before, world.after, world.ring.map, world.held, FewLandmarks(), {});
  ASSERT_TRUE(result);
  const Atlas corrected = Corrected(world.after, result->correction);
  for (const auto& [id, scale] : world.held) {
    EXPECT_EQ(corrected.FindKeyframe(id)->camera_from_map.translation(),
              world.after.FindKeyframe(id)->camera_from_map.translation());
  }
}

TEST(PoseGraph, AMeasuredLoopEdgeAloneClosesTheLoop) {
  const Ring ring = MakeRing({});
  const Similarity3d step_error(Rigid3d::Exp(Vector6d::Constant(0.002)));
  const Atlas before = Corrected(ring.atlas, PlaceAt(ring.atlas, ring.map, Drift(ring, step_error)));
  Atlas after = before;
  const KeyframeId first = ring.keyframes.front();
  const KeyframeId last = ring.keyframes.back();
  const Rigid3d measured = ring.camera_from_map.at(first) * ring.camera_from_map.at(last).Inverse();
  ASSERT_TRUE(Apply(AddLoopEdge{last, first, Similarity3d(measured)}, after));
  // Only tree edges: in this ring all neighbours see the same wall.
  const auto result = OptimizePoseGraph(before, after, ring.map, {}, {.strong_covisibility = 1000}, {});
  ASSERT_TRUE(result);
  EXPECT_LT(PositionError(ring, Corrected(after, result->correction)), 0.3 * PositionError(ring, before));
}

TEST(PoseGraph, AConsistentMapStaysWhereItIs) {
  const Ring ring = MakeRing({});
  const auto result = OptimizePoseGraph(ring.atlas, ring.atlas, ring.map, {}, FewLandmarks(), {});
  ASSERT_TRUE(result);
  EXPECT_LT(PositionError(ring, Corrected(ring.atlas, result->correction)), 1e-6);
}

TEST(PoseGraph, AStopOrAMapThatIsNotThereGivesNothing) {
  const Ring ring = MakeRing({.keyframes = 20, .landmarks = 50});
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(OptimizePoseGraph(ring.atlas, ring.atlas, ring.map, {}, FewLandmarks(), stop.get_token()));
  EXPECT_FALSE(OptimizePoseGraph(ring.atlas, ring.atlas, {1, 2}, {}, FewLandmarks(), {}));
}

TEST(PoseGraphOptions, OutOfRangeIsRefused) {
  EXPECT_TRUE(PoseGraphOptions{}.Check());
  EXPECT_FALSE(PoseGraphOptions{.strong_covisibility = 0}.Check());
  EXPECT_FALSE(PoseGraphOptions{.few_landmarks = 0}.Check());
  EXPECT_FALSE(PoseGraphOptions{.iterations = 0}.Check());
  EXPECT_FALSE(PoseGraphOptions{.cost_tolerance = -1.0}.Check());
  EXPECT_FALSE(PoseGraphOptions{.threads = 0}.Check());
  EXPECT_FALSE(PoseGraphOptions{.max_seconds = -1.0}.Check());
}

TEST(EssentialGraph, HoldsTreeCovisibilityAndLoopsEachOnce) {
  Ring ring = MakeRing({});
  const auto tree = EssentialGraph(ring.atlas, ring.atlas, ring.map, 1000);
  EXPECT_EQ(tree.size(), ring.keyframes.size() - 1);
  const auto dense = EssentialGraph(ring.atlas, ring.atlas, ring.map, 1);
  std::set<std::pair<KeyframeId, KeyframeId>> pairs;
  for (const PoseGraphEdge& edge : dense) {
    EXPECT_TRUE(pairs.insert(std::minmax(edge.from, edge.to)).second);
    const Rigid3d truth = ring.camera_from_map.at(edge.to) * ring.camera_from_map.at(edge.from).Inverse();
    EXPECT_LT((edge.to_from_from.translation() - truth.translation()).norm(), 1e-9);
  }
  std::size_t covisible = 0;
  ring.atlas.ForEachKeyframe([&](const Keyframe& keyframe) { covisible += keyframe.covisible.size(); });
  EXPECT_EQ(pairs.size(), covisible / 2);
  EXPECT_TRUE(EssentialGraph(ring.atlas, ring.atlas, {1, 2}, 1).empty());
}

TEST(MedianDepth, IsTheDistanceToTheWall) {
  const Ring ring = MakeRing({});
  EXPECT_NEAR(MedianDepth(ring.atlas, ring.map), 5.0, 0.5);
  EXPECT_EQ(MedianDepth(ring.atlas, {1, 2}), 1.0);
}

}  // namespace
}  // namespace pangaea::testing
