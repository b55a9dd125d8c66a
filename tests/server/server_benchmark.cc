#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

#include "common/base/check.h"
#include "server/storage/recovery.h"
#include "server/storage/snapshot_store.h"
#include "tests/server/flight.h"
#include "tests/server/service_harness.h"
#include "tests/server/temporary_store.h"

namespace pangaea {
namespace {

// As many keypoints and landmarks as a stereo keyframe has.
constexpr FlightShape kRealKeyframe{.keypoints = 1000, .observed = 250, .created = 100};
constexpr std::uint64_t kSite = 2000;  // keyframes

// A store with a journal of 2,000 keyframes; made once.
struct LargeStore {
  LargeStore() : store(Store::Open(place.path(), "hall", {}).value()) {
    for (std::uint64_t position = 1; position <= kSite; ++position) {
      PANGAEA_CHECK(store.Append({{{position, flight.Next()}}, {}, {}, {}}));
    }
  }
  TemporaryStore place;
  Store store;
  Flight flight{1, kRealKeyframe};
};

void RecoverEachTime(benchmark::State& state, LargeStore& large) {
  for (auto _ : state) {
    auto recovered = RecoverAtlas(large.store);
    PANGAEA_CHECK(recovered && recovered->atlas.keyframe_count() == kSite);
    benchmark::DoNotOptimize(recovered);
  }
  state.counters["store_MiB"] = static_cast<double>(large.store.Size().bytes) / (1 << 20);
}

void RecoverFromJournal(benchmark::State& state) {
  LargeStore large;
  RecoverEachTime(state, large);
}
BENCHMARK(RecoverFromJournal)->Unit(benchmark::kMillisecond);

void WriteFirstSnapshot(benchmark::State& state) {
  for (auto _ : state) {
    state.PauseTiming();
    auto large = std::make_unique<LargeStore>();
    auto snapshots = SnapshotStore::Open(large->place.path(), 0).value();
    state.ResumeTiming();
    PANGAEA_CHECK(snapshots.Write(large->flight.atlas(), kSite, 1, {}));
    state.PauseTiming();
    large.reset();
    state.ResumeTiming();
  }
}
BENCHMARK(WriteFirstSnapshot)->Unit(benchmark::kMillisecond)->Iterations(1);

void RecoverFromSnapshot(benchmark::State& state) {
  LargeStore large;
  PANGAEA_CHECK(SnapshotStore::Open(large.place.path(), 0).value().Write(large.flight.atlas(), kSite, 1, {}));
  RecoverEachTime(state, large);
}
BENCHMARK(RecoverFromSnapshot)->Unit(benchmark::kMillisecond);

// Envelopes of about the size given (KB), as fast as the service takes them.
void IngestThroughput(benchmark::State& state) {
  constexpr std::uint64_t kEnvelopes = 500;
  const FlightShape shape{
      .keypoints = static_cast<std::size_t>(state.range(0)) * 1000 / 40, .observed = 250, .created = 100};
  std::size_t bytes = 0;
  for (auto _ : state) {
    state.PauseTiming();
    Flight flight(1, shape);
    std::vector<Envelope> envelopes;
    for (std::uint64_t i = 0; i < kEnvelopes; ++i) envelopes.push_back(flight.Next());
    for (const Envelope& envelope : envelopes) bytes += envelope.edits.size();
    TemporaryStore place;
    auto harness = std::make_unique<ServiceHarness>(place.path());
    state.ResumeTiming();
    for (Envelope& envelope : envelopes) harness->Send(std::move(envelope));
    harness->WaitForAck(1, kEnvelopes);
    state.PauseTiming();
    harness.reset();
    state.ResumeTiming();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * kEnvelopes));
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes));
}
BENCHMARK(IngestThroughput)->Arg(40)->Arg(100)->Unit(benchmark::kMillisecond)->UseRealTime();

// From submitting one keyframe to its ack, nothing else going on.
void AcknowledgeLatency(benchmark::State& state) {
  const TemporaryStore place;
  ServiceHarness harness(place.path());
  Flight flight(1, kRealKeyframe);
  std::uint64_t sequence = 0;
  for (auto _ : state) {
    state.PauseTiming();
    Envelope envelope = flight.Next();
    state.ResumeTiming();
    harness.Send(std::move(envelope));
    harness.WaitForAck(1, ++sequence);
  }
}
BENCHMARK(AcknowledgeLatency)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace pangaea
