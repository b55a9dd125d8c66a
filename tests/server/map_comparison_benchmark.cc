// What comparing two maps as wholes costs the server: once for each pair of maps that no keyframe joins.
#include <benchmark/benchmark.h>

#include "server/map_comparison/map_comparison.h"
#include "server/map_comparison/map_sample.h"
#include "tests/server/strewn_places.h"

namespace pangaea {
namespace {

// Two maps of so many landmarks, of one place where three of a hundred things look as before, or of two places.
Atlas TwoMaps(int landmarks, bool one_place) {
  Strewer strewer(1);
  const std::vector<Thing> before = strewer.Things(landmarks);
  Atlas atlas;
  Survey(kAnna, before, Rigid3d(), atlas);
  const auto kept = static_cast<std::size_t>(landmarks) * 3 / 100;
  Survey(kBert, one_place ? Repainted(before, kept, strewer) : strewer.Things(landmarks), kWhereBertBegan, atlas);
  return atlas;
}

void Compare(benchmark::State& state, bool one_place) {
  const Atlas atlas = TwoMaps(static_cast<int>(state.range(0)), one_place);
  for (auto _ : state) {
    const MapComparison comparison = CompareMaps(atlas, M(1, kBert), M(1), {});
    if (comparison.match.has_value() != one_place) state.SkipWithError("another answer");
  }
}
void CompareOnePlace(benchmark::State& state) { Compare(state, true); }
void CompareTwoPlaces(benchmark::State& state) { Compare(state, false); }
BENCHMARK(CompareOnePlace)->Arg(1500)->Arg(6000)->Unit(benchmark::kMillisecond);
BENCHMARK(CompareTwoPlaces)->Arg(1500)->Arg(6000)->Unit(benchmark::kMillisecond);

void ChooseLandmarks(benchmark::State& state) {
  const Atlas atlas = TwoMaps(static_cast<int>(state.range(0)), true);
  for (auto _ : state) benchmark::DoNotOptimize(SampleMap(atlas, M(1), {}));
}
BENCHMARK(ChooseLandmarks)->Arg(6000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pangaea
