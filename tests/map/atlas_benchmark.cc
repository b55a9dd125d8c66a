#include <benchmark/benchmark.h>

#include "common/base/check.h"
#include "common/map/atlas_codec.h"
#include "common/map/digest.h"
#include "common/map/map_edit.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

constexpr std::uint32_t kKeypoints = 1000;
constexpr std::uint32_t kNewPerKeyframe = 200;
constexpr std::uint32_t kSeenAgain = 300;  // landmarks of the keyframes before

// The edits of a camera that goes along a corridor: each keyframe sees some landmarks of the last ones and makes new
// ones.
std::vector<MapEdit> Corridor(std::uint32_t keyframes) {
  const auto data = MakeData(kKeypoints);
  std::vector<MapEdit> edits;
  for (std::uint32_t k = 1; k <= keyframes; ++k) {
    const KeyframeId parent = k == 1 ? KeyframeId{} : K(k - 1);
    edits.push_back(AddKeyframe{K(k), M(1), parent, MakePose(0.01, 0.1, 0.0, 0.1), data});
    const std::uint32_t made = (k - 1) * kNewPerKeyframe;
    for (std::uint32_t i = 0; i < std::min(kSeenAgain, made / 4); ++i) {
      edits.push_back(AddObservation{L(made - 4 * i), K(k), kNewPerKeyframe + i});
    }
    for (std::uint32_t i = 0; i < kNewPerKeyframe; ++i) {
      edits.push_back(AddLandmark{L(made + i + 1), K(k), i, {0.01 * i, 0.3, 5.0}});
    }
  }
  return edits;
}

Atlas Build(std::span<const MapEdit> edits) {
  Atlas atlas;
  for (const MapEdit& edit : edits) PANGAEA_CHECK(Apply(edit, atlas));
  return atlas;
}

const Atlas& HundredThousandLandmarks() {
  static const Atlas kAtlas = Build(Corridor(500));
  return kAtlas;
}

void SnapshotAfterOneEdit(benchmark::State& state) {
  Atlas atlas = HundredThousandLandmarks();
  Atlas snapshot = atlas;
  std::uint32_t i = 0;
  for (auto _ : state) {
    const std::uint32_t counter = 1 + (i += 7919) % 100000;
    PANGAEA_CHECK(Apply(MoveLandmarks{{{L(counter), {0.1, 0.2, 4.0}}}}, atlas));
    snapshot = atlas;
    benchmark::DoNotOptimize(snapshot);
  }
}
BENCHMARK(SnapshotAfterOneEdit)->Unit(benchmark::kMicrosecond);

// A snapshot, then all edits of one keyframe.
void ApplyKeyframe(benchmark::State& state) {
  const auto edits = Corridor(502);
  const std::size_t first = Corridor(500).size();
  const Atlas& base = HundredThousandLandmarks();
  for (auto _ : state) {
    Atlas atlas = base;
    for (std::size_t i = first; i < edits.size(); ++i) PANGAEA_CHECK(Apply(edits[i], atlas));
    benchmark::DoNotOptimize(atlas);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(edits.size() - first));
}
BENCHMARK(ApplyKeyframe)->Unit(benchmark::kMicrosecond);

void ApplyThroughput(benchmark::State& state) {
  const auto edits = Corridor(100);
  for (auto _ : state) benchmark::DoNotOptimize(Build(edits));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(edits.size()));
}
BENCHMARK(ApplyThroughput)->Unit(benchmark::kMillisecond);

void EncodeAndDecodeEdits(benchmark::State& state) {
  const auto edits = Corridor(20);
  std::size_t bytes = 0;
  for (auto _ : state) {
    const auto encoded = EncodeEdits(edits);
    bytes = encoded.size();
    PANGAEA_CHECK(DecodeEdits(encoded));
  }
  state.counters["bytes_per_keyframe"] = static_cast<double>(bytes) / 20.0;
}
BENCHMARK(EncodeAndDecodeEdits)->Unit(benchmark::kMillisecond);

void DigestOfAll(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(Digest(HundredThousandLandmarks()));
}
BENCHMARK(DigestOfAll)->Unit(benchmark::kMillisecond);

void StoreAndRestore(benchmark::State& state) {
  const Atlas& atlas = HundredThousandLandmarks();
  std::size_t bytes = 0;
  for (auto _ : state) {
    const auto encoded = EncodeAtlas(atlas);
    bytes = encoded.size();
    PANGAEA_CHECK(DecodeAtlas(encoded, [&](KeyframeId id) { return atlas.FindKeyframe(id)->data; }));
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK(StoreAndRestore)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pangaea
