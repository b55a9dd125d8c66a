#include <benchmark/benchmark.h>

#include "server/optimization/global_bundle_adjustment.h"
#include "server/optimization/pose_graph.h"
#include "tests/server/optimization_ring.h"

namespace pangaea::testing {
namespace {

void RebaseOntoAMapOfThousandKeyframes(benchmark::State& state) {
  const Ring ring = MakeRing({.keyframes = 1000, .landmarks = 20000, .views = 5, .spread = 12});
  const Correction correction = Disturb(ring, 3, 0.02, 0.01, 0.05);
  for (auto _ : state) benchmark::DoNotOptimize(Rebase(correction, ring.atlas));
}
BENCHMARK(RebaseOntoAMapOfThousandKeyframes)->Unit(benchmark::kMillisecond);

// A loop of 2,000 keyframes whose ends meet, each with some ten strong edges.
void PoseGraphOf2000Keyframes(benchmark::State& state) {
  const bool stereo = state.range(0) != 0;
  const Ring ring = MakeRing({.keyframes = 2000, .landmarks = 60000, .views = 10, .spread = 12, .stereo = stereo});
  const Similarity3d step_error(stereo ? 1.0 : 1.0002, ExpSo3({0.0001, 0.0002, 0.0}), {0.0005, 0.0, 0.0003});
  const auto cameras = Drift(ring, step_error);
  const Atlas before = Corrected(ring.atlas, PlaceAt(ring.atlas, ring.map, cameras));
  std::map<KeyframeId, Similarity3d> seam;
  std::map<KeyframeId, double> held = {{ring.keyframes.front(), 1.0}};
  for (std::size_t i = 1990; i < 2000; ++i) {
    const KeyframeId id = ring.keyframes[i];
    held[id] = cameras.at(id).scale();
    seam[id] = Similarity3d(1.0 / held[id], ring.camera_from_map.at(id).rotation(),
                            ring.camera_from_map.at(id).translation() / held[id]);
  }
  const Atlas after = Corrected(before, PlaceAt(before, ring.map, seam));
  for (auto _ : state) {
    const auto result = OptimizePoseGraph(before, after, ring.map, held, {}, {});
    state.counters["edges"] = static_cast<double>(result->edges);
    state.counters["iterations"] = result->iterations;
  }
}
BENCHMARK(PoseGraphOf2000Keyframes)->ArgName("stereo")->Arg(1)->Arg(0)->Unit(benchmark::kMillisecond);

void GlobalBundleOf1000Keyframes(benchmark::State& state) {
  const Ring ring = MakeRing({.keyframes = 1000,
                              .landmarks = 50000,
                              .views = 11,
                              .spread = 30,
                              .closed = true,
                              .noise = 0.5,
                              .outliers = 0.01});
  const Atlas disturbed = Corrected(ring.atlas, Disturb(ring, 3, 0.02, 0.01, 0.05));
  GlobalBundleOptions options;
  if (state.range(0) != 0) options.direct_pairs = 0;
  for (auto _ : state) {
    const auto bundle = AdjustMap(disturbed, ring.map, options, {});
    state.counters["observations"] = static_cast<double>(bundle->observations);
    state.counters["iterations"] = bundle->iterations;
  }
}
BENCHMARK(GlobalBundleOf1000Keyframes)->ArgName("iterative")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pangaea::testing
