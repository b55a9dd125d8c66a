#include "server/runtime/optimization_thread.h"

#include <spdlog/spdlog.h>

#include <string>
#include <utility>

#include "server/runtime/stopwatch.h"
#include "server/runtime/thread_priority.h"

namespace pangaea {
namespace {

constexpr int kNice = 19;

}  // namespace

OptimizationThread::OptimizationThread(AtlasService& service, Jobs jobs, const OptimizationAgendaOptions& options,
                                       std::function<void()> finished, WorkLedger& ledger)
    : service_(service), jobs_(std::move(jobs)), finished_(std::move(finished)), ledger_(ledger), agenda_(options) {}

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
  while (bell_.Wait(stop)) {
    while (!stop.stop_requested()) {
      const auto state = service_.State();
      const auto map = Begin(state->ingest.atlas);
      if (!map) {
        Tidy(state->ingest, stop);
        break;
      }
      Optimize(state->ingest.atlas, *map, stop);
      finished_();
    }
  }
}

std::optional<MapId> OptimizationThread::Begin(const Atlas& atlas) {
  MutexLock lock(mutex_);
  agenda_.Update(atlas);
  const auto map = agenda_.Start(atlas);
  if (map) running_ = std::stop_source();
  const std::size_t waiting = agenda_.waiting();
  ledger_.Write([&](WorkReport& report) {
    report.optimizing = map;
    report.optimizations_waiting = waiting;
    report.planned_version = atlas.version();
  });
  return map;
}

void OptimizationThread::Optimize(const Atlas& snapshot, MapId map, const std::stop_token& stop) {
  std::stop_source running;
  {
    MutexLock lock(mutex_);
    running = running_;
  }
  const std::stop_callback end(stop, [&running] { running.request_stop(); });
  const Stopwatch watch;
  const auto optimized = jobs_.optimize(snapshot, map, running.get_token());
  const double milliseconds = watch.milliseconds();
  const bool cancelled = running.stop_requested();
  if (!cancelled) ledger_.Keep("global_bundle", watch);
  if (optimized && !cancelled) Propose(*optimized);
  std::size_t waiting = 0;
  {
    MutexLock lock(mutex_);
    agenda_.Finish(!cancelled);
    waiting = agenda_.waiting();
  }
  spdlog::info("global bundle adjustment of map {} {} after {:.0f} ms", ToString(map),
               cancelled   ? "cancelled"
               : optimized ? "done"
                           : "found nothing better",
               milliseconds);
  ledger_.Write([&](WorkReport& report) {
    report.optimizing.reset();
    report.optimizations_waiting = waiting;
    if (cancelled) ++report.cancelled_optimizations;
    if (!cancelled) report.global_ms.Add(milliseconds);
  });
}

void OptimizationThread::Propose(const OptimizedMap& optimized) {
  const auto rebase = [&optimized](const Atlas& current) { return OptimizationEdits(optimized, current); };
  const auto answer = service_.ProposeAndWait({{"optimization"}, rebase});
  if (!answer) spdlog::warn("the result of a global bundle adjustment was not taken: {}", answer.error().message);
}

void OptimizationThread::Tidy(const IngestState& snapshot, const std::stop_token& stop) {
  if (snapshot.atlas.keyframe_count() <= tidied_keyframes_) return;
  tidied_keyframes_ = snapshot.atlas.keyframe_count();
  const std::vector<MapEdit> edits = jobs_.tidy(snapshot, stop);
  if (edits.empty()) return;
  EditsProposed proposal;
  proposal.cause.kind = "culling";
  proposal.make = [&edits](const Atlas& current) {
    Atlas draft = current;
    return Result<std::vector<MapEdit>>(ApplyTolerantly(edits, draft));
  };
  proposal.event =
      AtlasEvent{{}, AtlasEventKind::kCulled, std::to_string(edits.size()) + " keyframes and landmarks", 0, 0};
  const auto answer = service_.ProposeAndWait(std::move(proposal));
  if (!answer) return spdlog::warn("nothing was culled: {}", answer.error().message);
  tidied_keyframes_ = service_.State()->ingest.atlas.keyframe_count();
  ledger_.Write([&](WorkReport& report) { report.culled += answer->edits; });
}

}  // namespace pangaea
