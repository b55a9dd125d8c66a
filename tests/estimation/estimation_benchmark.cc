#include <benchmark/benchmark.h>

#include <array>

#include "common/estimation/absolute_pose.h"
#include "common/estimation/bundle_adjustment.h"
#include "common/estimation/pose_refinement.h"
#include "common/geometry/perspective_three_point.h"
#include "tests/estimation/synthetic_world.h"

namespace pangaea::testing {
namespace {

void RefinePoseOf300(benchmark::State& state) {
  const PoseWorld world = MakePoseWorld(1, {.noise = 1.0, .outlier_ratio = 0.1, .stereo = state.range(0) != 0});
  Random random(2);
  const Rigid3d initial = Perturbed(random, world.camera_from_map, 0.05, 0.02);
  std::vector<std::uint8_t> inliers(world.observations.size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(RefinePose(world.camera, initial, world.observations, {}, inliers));
  }
}
BENCHMARK(RefinePoseOf300)->ArgName("stereo")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

void SolveThreePoints(benchmark::State& state) {
  Random random(3);
  std::array<Eigen::Vector3d, 3> points;
  std::array<Eigen::Vector3d, 3> bearings;
  for (int i = 0; i < 3; ++i) {
    points[i] = VisiblePoint(random, MonocularCamera(), 1.0, 15.0);
    bearings[i] = points[i].normalized();
  }
  for (auto _ : state) benchmark::DoNotOptimize(SolvePerspectiveThreePoint(bearings, points));
}
BENCHMARK(SolveThreePoints)->Unit(benchmark::kMicrosecond);

void AbsolutePoseOf300(benchmark::State& state) {
  const PoseWorld world = MakePoseWorld(1, {.noise = 1.0, .outlier_ratio = 0.01 * static_cast<double>(state.range(0))});
  std::uint64_t seed = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(EstimateAbsolutePose(world.camera, world.observations, {}, ++seed));
  }
}
BENCHMARK(AbsolutePoseOf300)->ArgName("outlier_percent")->Arg(10)->Arg(40)->Arg(70)->Unit(benchmark::kMicrosecond);

// 15 free and 20 fixed keyframes, some 10,000 observations, five steps.
void LocalBundle(benchmark::State& state, BundleSolver solver) {
  BundleWorldOptions world_options;
  world_options.free_poses = 15;
  world_options.fixed_poses = 20;
  world_options.points = 660;
  world_options.outlier_ratio = 0.05;
  world_options.seen_ratio = 0.45;
  const BundleWorld world = MakeBundleWorld(1, world_options);
  BundleOptions options;
  options.solver = solver;
  options.cost_tolerance = 0.0;
  int iterations = 0;
  for (auto _ : state) iterations = SolveBundle(world.problem, options)->iterations;
  state.counters["observations"] = static_cast<double>(world.problem.observations.size());
  state.counters["iterations"] = iterations;
}
BENCHMARK_CAPTURE(LocalBundle, own, BundleSolver::kLocal)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(LocalBundle, ceres_dense_schur, BundleSolver::kDenseSchur)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(LocalBundle, ceres_sparse_schur, BundleSolver::kSparseSchur)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pangaea::testing
