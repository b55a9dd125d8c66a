#include "server/runtime/welding_thread.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "server/atlas/welding_edits.h"
#include "server/runtime/unix_clock.h"

namespace pangaea {
namespace {

bool IsMerge(const PlaceMatch& match, const Atlas& atlas) {
  const Keyframe* query = atlas.FindKeyframe(atlas.Resolve(match.query));
  const Keyframe* candidate = atlas.FindKeyframe(atlas.Resolve(match.candidate));
  return query != nullptr && candidate != nullptr && query->map != candidate->map;
}

WeldReport ReportOf(const PlaceMatch& match, bool merge) {
  WeldReport report;
  report.merge = merge;
  report.sessions = {match.query.session};
  if (match.candidate.session != match.query.session) report.sessions.push_back(match.candidate.session);
  report.unix_ns = UnixNanoseconds();
  return report;
}

}  // namespace

WeldingThread::WeldingThread(AtlasService& service, const FusionOptions& fusion, const PoseGraphOptions& pose_graph,
                             WeldingAgenda agenda, Links links, WorkLedger& ledger)
    : service_(service),
      fusion_(fusion),
      pose_graph_(pose_graph),
      links_(std::move(links)),
      ledger_(ledger),
      agenda_(std::move(agenda)) {}

void WeldingThread::Start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

void WeldingThread::Stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void WeldingThread::Add(PlaceMatch match) {
  {
    MutexLock lock(mutex_);
    agenda_.Add(std::move(match));
    const std::size_t waiting = agenda_.waiting();
    ledger_.Write([waiting](WorkReport& report) { report.matches_waiting = waiting; });
  }
  bell_.Ring();
}

void WeldingThread::Run(const std::stop_token& stop) {
  // It stands back for nobody: welds are rare and short, and agents wait for them.
  while (bell_.Wait(stop)) {
    while (!stop.stop_requested()) {
      const auto state = service_.State();
      const auto match = Next(state->ingest.atlas);
      if (!match) break;
      Weld(*match, state->ingest.atlas, stop);
      ledger_.Write([](WorkReport& report) { report.welding = false; });
    }
  }
}

std::optional<PlaceMatch> WeldingThread::Next(const Atlas& atlas) {
  MutexLock lock(mutex_);
  auto match = agenda_.Next(atlas, links_.holds_loops);
  const std::size_t waiting = agenda_.waiting();
  spdlog::debug("welding: {} matches wait, {} had no sense any more", waiting, agenda_.dropped());
  ledger_.Write([&](WorkReport& report) {
    report.matches_waiting = waiting;
    report.welding = match.has_value();
  });
  return match;
}

void WeldingThread::Weld(const PlaceMatch& match, const Atlas& snapshot, const std::stop_token& stop) {
  const Stopwatch watch;
  const WeldingOutcome plan = PlanWelding(snapshot, match, fusion_, stop);
  if (!plan) {
    const WeldingRefusalReason reason = plan.error().reason;
    spdlog::debug("no weld of {} and {}: {}", ToString(match.query), ToString(match.candidate), Describe(plan.error()));
    if (reason == WeldingRefusalReason::kCancelled || reason == WeldingRefusalReason::kGone) return;
    return Refused(match, IsMerge(match, snapshot), Describe(plan.error()));
  }
  ledger_.Keep("seam", watch);
  if (plan->is_merge()) {
    WeldMerge(match, *plan, watch, stop);
  } else {
    WeldLoop(match, *plan, watch, stop);
  }
}

// The seam at once, so that agents work on one map; the rest of the map follows.
void WeldingThread::WeldMerge(const PlaceMatch& match, const WeldingPlan& plan, const Stopwatch& watch,
                              const std::stop_token& stop) {
  const ProposalAnswer answer = Propose(plan, std::nullopt);
  if (!answer) return Refused(match, true, answer.error().message);
  Welded(match, plan, answer->cause, watch);
  const auto spread = Spread(plan, stop);
  if (!spread) return;
  const auto rebase = [&spread](ServerDraft& draft) { return OptimizationEdits({{}, {*spread}, {}}, draft); };
  const auto spread_out = service_.ProposeAndWait({answer->cause, rebase});
  if (!spread_out) spdlog::warn("{}: no pose graph: {}", answer->cause.Text(), spread_out.error().message);
}

// Seam and rest together: in between, the ends of the loop would lie apart from what they hang on.
void WeldingThread::WeldLoop(const PlaceMatch& match, const WeldingPlan& plan, const Stopwatch& watch,
                             const std::stop_token& stop) {
  const auto spread = Spread(plan, stop);
  if (!spread) return;
  const ProposalAnswer answer = Propose(plan, spread);
  if (!answer) return Refused(match, false, answer.error().message);
  Welded(match, plan, answer->cause, watch);
}

std::optional<Correction> WeldingThread::Spread(const WeldingPlan& plan, const std::stop_token& stop) {
  const Stopwatch watch;
  auto spread = OptimizePoseGraph(plan.correction.base, plan.after_seam, plan.map, plan.held, pose_graph_, stop);
  if (!spread) return std::nullopt;
  spdlog::debug("pose graph of map {}: {} edges, cost {:.3g} to {:.3g}, {:.0f} ms", ToString(plan.map), spread->edges,
                spread->initial_cost, spread->final_cost, watch.milliseconds());
  ledger_.Keep("pose_graph", watch);
  ledger_.Write([&](WorkReport& report) { report.pose_graph_ms.Add(watch.milliseconds()); });
  return std::move(spread->correction);
}

ProposalAnswer WeldingThread::Propose(const WeldingPlan& plan, const std::optional<Correction>& spread) {
  EditsProposed proposal;
  proposal.cause.kind = plan.is_merge() ? "merge" : "loop";
  proposal.make = [&](ServerDraft& draft) { return WeldingEdits(plan, spread, draft); };
  proposal.event = AtlasEvent{
      {}, plan.is_merge() ? AtlasEventKind::kMerge : AtlasEventKind::kLoop, Describe(plan), plan.moved.session, 0};
  proposal.keep_before = plan.is_merge();
  return service_.ProposeAndWait(std::move(proposal));
}

void WeldingThread::Welded(const PlaceMatch& match, const WeldingPlan& plan, const Cause& cause,
                           const Stopwatch& watch) {
  const double milliseconds = watch.milliseconds();
  ledger_.Keep(plan.is_merge() ? "merge" : "loop", watch);
  WeldReport weld = ReportOf(match, plan.is_merge());
  weld.cause = cause.Text();
  weld.text = Describe(plan);
  weld.milliseconds = milliseconds;
  ledger_.Write([&](WorkReport& report) {
    (weld.merge ? report.merge_ms : report.loop_ms).Add(milliseconds);
    ++(weld.merge ? report.merges : report.loops);
    report.Remember(report.welds, std::move(weld));
  });
  links_.welded(plan);
}

void WeldingThread::Refused(const PlaceMatch& match, bool merge, const std::string& why) {
  WeldReport refusal = ReportOf(match, merge);
  refusal.text = why;
  ledger_.Write([&](WorkReport& report) {
    ++report.refused;
    report.Remember(report.refusals, std::move(refusal));
  });
  const std::string what = std::string(merge ? "merge" : "loop") + " of " + ToString(match.query) + " and " +
                           ToString(match.candidate) + " refused: " + why;
  links_.report({service_.site(), AtlasEventKind::kWeldRefused, what, match.query.session, UnixNanoseconds()});
}

}  // namespace pangaea
