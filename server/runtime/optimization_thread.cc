#include "server/runtime/optimization_thread.h"

#include <spdlog/spdlog.h>

#include <string>
#include <utility>

#include "common/base/process_memory.h"
#include "server/runtime/stopwatch.h"
#include "server/runtime/thread_priority.h"

namespace pangaea {
namespace {

constexpr int kNice = 10;

// What was seen of the map, and no longer what was seen of maps that are gone.
const LookedAtMap& Recall(MapId map, const Atlas& snapshot, LookMemory& memory) {
  std::erase_if(memory, [&](const auto& entry) { return snapshot.FindMap(entry.first) == nullptr; });
  return memory[map];
}

}  // namespace

OptimizationThread::OptimizationThread(AtlasService& service, Jobs jobs, const OptimizationAgendaOptions& options,
                                       std::function<void()> finished, WorkLedger& ledger)
    : service_(service),
      jobs_(std::move(jobs)),
      finished_(std::move(finished)),
      ledger_(ledger),
      agenda_(options),
      economy_agenda_(options.growth, options.patience) {}

void OptimizationThread::Start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

void OptimizationThread::Stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void OptimizationThread::Welded(MapId map, MapId absorbed) {
  {
    MutexLock lock(mutex_);
    bool cancel = agenda_.MapWelded(map);
    if (absorbed.valid()) cancel = agenda_.MapWelded(absorbed) || cancel;
    cancel = economy_agenda_.MapWelded(map) || economy_agenda_.MapWelded(absorbed) || cancel;
    if (cancel) running_.request_stop();
    const std::size_t waiting = agenda_.waiting();
    ledger_.Write([waiting](WorkReport& report) { report.optimizations_waiting = waiting; });
  }
  bell_.Ring();
}

bool OptimizationThread::HoldsLoops(MapId map) const {
  MutexLock lock(mutex_);
  return agenda_.HoldsLoops(map);
}

void OptimizationThread::Run(const std::stop_token& stop) {
  StandBack(kNice);
  {
    const auto state = service_.State();
    MutexLock lock(mutex_);
    economy_agenda_.Recover(state->ingest.atlas);
  }
  while (bell_.Wait(stop)) {
    bool worked = false;
    while (!stop.stop_requested() && Work(stop)) worked = true;
    // Adjusting a whole map takes several times its size for a while.
    if (worked) ReturnFreeMemory();
  }
}

bool OptimizationThread::Work(const std::stop_token& stop) {
  const auto state = service_.State();
  if (const auto map = Begin(state->ingest)) {
    const bool done = Optimize(state->ingest.atlas, *map, stop);
    finished_();
    // Now, too, where one map or another is always due: the larger they grow, the longer each takes.
    if (done) Economize(service_.State()->ingest, map, stop);
    return true;
  }
  if (Economize(state->ingest, std::nullopt, stop)) return true;
  Tidy(state->ingest, stop);
  ledger_.Write([&](WorkReport& report) {
    report.planned_version = state->ingest.atlas.version();
    report.planned_living = state->ingest.living();
  });
  return false;
}

void OptimizationThread::TakeIn(const IngestState& state) {
  for (const auto& [id, session] : state.sessions) {
    if (session.closed_maps() == 0) continue;
    const std::uint64_t seen = std::exchange(closed_maps_[id], session.closed_maps());
    if (seen != session.closed_maps()) agenda_.SessionClosedMap(state.atlas, id);
  }
  agenda_.Update(state.atlas);
}

std::optional<MapId> OptimizationThread::Begin(const IngestState& state) {
  const Atlas& atlas = state.atlas;
  MutexLock lock(mutex_);
  TakeIn(state);
  const auto map = agenda_.Start(atlas);
  if (map) running_ = std::stop_source();
  const std::size_t waiting = agenda_.waiting();
  ledger_.Write([&](WorkReport& report) {
    report.optimizing = map;
    report.optimizations_waiting = waiting;
    if (map) report.planned_version = atlas.version();
  });
  return map;
}

std::stop_source OptimizationThread::Running() const {
  MutexLock lock(mutex_);
  return running_;
}

bool OptimizationThread::Optimize(const Atlas& snapshot, MapId map, const std::stop_token& stop) {
  std::stop_source running = Running();
  const std::stop_callback end(stop, [&running] { running.request_stop(); });
  const Stopwatch watch;
  auto optimized = jobs_.optimize(snapshot, map, Recall(map, snapshot, looked_at_), running.get_token());
  const double milliseconds = watch.milliseconds();
  const bool cancelled = running.stop_requested();
  if (!cancelled) ledger_.Keep("global_bundle", watch);
  const bool better = optimized.has_value();
  const std::size_t fused =
      !better ? 0 : static_cast<std::size_t>(std::ranges::count_if(optimized->joins, [](const MapEdit& edit) {
        return std::holds_alternative<FuseLandmarks>(edit);
      }));
  if (optimized && !cancelled) Propose(map, std::move(*optimized));
  std::size_t waiting = 0;
  {
    MutexLock lock(mutex_);
    agenda_.Finish(!cancelled, fused);
    waiting = agenda_.waiting();
  }
  spdlog::info("global bundle adjustment of map {} {} after {:.0f} ms", ToString(map),
               cancelled ? "cancelled"
               : better  ? "done"
                         : "found nothing better",
               milliseconds);
  ledger_.Write([&](WorkReport& report) {
    report.optimizing.reset();
    report.optimizations_waiting = waiting;
    if (cancelled) ++report.cancelled_optimizations;
    if (!cancelled) report.global_ms.Add(milliseconds);
  });
  return !cancelled;
}

void OptimizationThread::Propose(MapId map, OptimizedMap optimized) {
  const auto rebase = [&optimized](ServerDraft& draft) { return OptimizationEdits(optimized, draft); };
  const auto answer = service_.ProposeAndWait({{"optimization"}, rebase});
  if (!answer) {
    spdlog::warn("the result of a global bundle adjustment was not taken: {}", answer.error().message);
  } else if (optimized.looked_at) {
    looked_at_[map] = std::move(*optimized.looked_at);
  }
}

// True when the atlas is another: then there may be more to do.
bool OptimizationThread::Economize(const IngestState& snapshot, std::optional<MapId> only,
                                   const std::stop_token& stop) {
  if (!jobs_.economize) return false;
  const std::set<KeyframeId> in_use = jobs_.in_use(snapshot);
  while (const auto map = BeginEconomy(snapshot.atlas, in_use, only)) {
    const Stopwatch watch;
    auto economy = EconomizeOne(snapshot.atlas, *map, in_use, stop);
    const bool taken = economy && (economy->empty() || Take(*economy));
    if (taken && economy->changes.looked_at) economized_[*map] = std::move(*economy->changes.looked_at);
    ledger_.Write([](WorkReport& report) { report.economizing = false; });
    MutexLock lock(mutex_);
    if (!taken) {
      economy_agenda_.Cancel();
      return false;
    }
    economy_agenda_.Finish(economy->after, in_use);
    if (economy->empty()) continue;
    spdlog::info("{}; {:.0f} ms", Describe(*economy), watch.milliseconds());
    agenda_.MapChanged(*map);
    return true;
  }
  return false;
}

std::optional<MapId> OptimizationThread::BeginEconomy(const Atlas& snapshot, const std::set<KeyframeId>& in_use,
                                                      std::optional<MapId> only) {
  MutexLock lock(mutex_);
  const auto map = economy_agenda_.Next(snapshot, in_use, only);
  if (!map) return std::nullopt;
  economy_agenda_.Start(*map);
  running_ = std::stop_source();
  return map;
}

std::optional<MapEconomy> OptimizationThread::EconomizeOne(const Atlas& snapshot, MapId map,
                                                           const std::set<KeyframeId>& in_use,
                                                           const std::stop_token& stop) {
  std::stop_source running = Running();
  const std::stop_callback end(stop, [&running] { running.request_stop(); });
  ledger_.Write([](WorkReport& report) { report.economizing = true; });
  auto economy = jobs_.economize(snapshot, map, in_use, Recall(map, snapshot, economized_), running.get_token());
  if (running.stop_requested()) return std::nullopt;
  return economy;
}

bool OptimizationThread::Take(const MapEconomy& economy) {
  EditsProposed proposal;
  proposal.cause.kind = "culling";
  proposal.make = [&economy](ServerDraft& draft) { return OptimizationEdits(economy.changes, draft); };
  proposal.event = AtlasEvent{{}, AtlasEventKind::kCulled, Describe(economy), 0, 0};
  const auto answer = service_.ProposeAndWait(std::move(proposal));
  if (!answer) {
    spdlog::warn("a map was not made smaller: {}", answer.error().message);
    return false;
  }
  ledger_.Write([&](WorkReport& report) {
    report.fused += economy.fused;
    report.culled_landmarks += economy.landmarks;
    report.culled_keyframes += economy.keyframes;
    report.culled += economy.landmarks + economy.keyframes;
  });
  return true;
}

void OptimizationThread::Tidy(const IngestState& snapshot, const std::stop_token& stop) {
  if (snapshot.atlas.keyframe_count() <= tidied_keyframes_) return;
  tidied_keyframes_ = snapshot.atlas.keyframe_count();
  const std::vector<MapEdit> edits = jobs_.tidy(snapshot, stop);
  if (edits.empty()) return;
  EditsProposed proposal;
  proposal.cause.kind = "culling";
  proposal.make = [&edits](ServerDraft& draft) { return OptimizationEdits({{}, {}, edits}, draft); };
  proposal.event =
      AtlasEvent{{}, AtlasEventKind::kCulled, std::to_string(edits.size()) + " keyframes and landmarks", 0, 0};
  const auto answer = service_.ProposeAndWait(std::move(proposal));
  if (!answer) return spdlog::warn("nothing was culled: {}", answer.error().message);
  tidied_keyframes_ = service_.State()->ingest.atlas.keyframe_count();
  ledger_.Write([&](WorkReport& report) { report.culled += answer->edits; });
}

}  // namespace pangaea
