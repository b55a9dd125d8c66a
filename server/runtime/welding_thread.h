#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <thread>

#include "common/base/mutex.h"
#include "server/atlas/welding_agenda.h"
#include "server/fusion/welding.h"
#include "server/optimization/pose_graph.h"
#include "server/runtime/atlas_service.h"
#include "server/runtime/bell.h"
#include "server/runtime/stopwatch.h"
#include "server/runtime/work_report.h"

namespace pangaea {

// Makes merges and loops of verified matches, one at a time: plans on a snapshot, proposes to the atlas thread, spreads
// the correction with a pose graph. Never waits for an optimisation, and ingest never waits for it.
class WeldingThread {
 public:
  struct Links {
    std::function<void(const AtlasEvent&)> report;   // of refusals; any thread
    std::function<void(const WeldingPlan&)> welded;  // it is durable
    std::function<bool(MapId)> holds_loops;          // loops in this map have to wait
  };
  WeldingThread(AtlasService& service, const FusionOptions& fusion, const PoseGraphOptions& pose_graph,
                WeldingAgenda agenda, Links links, WorkLedger& ledger);
  ~WeldingThread() { Stop(); }

  void Start();
  void RequestStop() { thread_.request_stop(); }
  // Gives up what it is planning.
  void Stop();
  // Any thread.
  void Add(PlaceMatch match) EXCLUDES(mutex_);
  // Any thread: loops that had to wait may not have to any more.
  void Notify() { bell_.Ring(); }

 private:
  void Run(const std::stop_token& stop);
  std::optional<PlaceMatch> Next(const Atlas& atlas) EXCLUDES(mutex_);
  void Weld(const PlaceMatch& match, const Atlas& snapshot, const std::stop_token& stop);
  void WeldMerge(const PlaceMatch& match, const WeldingPlan& plan, const Stopwatch& watch, const std::stop_token& stop);
  void WeldLoop(const PlaceMatch& match, const WeldingPlan& plan, const Stopwatch& watch, const std::stop_token& stop);
  std::optional<Correction> Spread(const WeldingPlan& plan, const std::stop_token& stop);
  ProposalAnswer Propose(const WeldingPlan& plan, const std::optional<Correction>& spread);
  void Welded(const PlaceMatch& match, const WeldingPlan& plan, const Cause& cause, const Stopwatch& watch);
  void Refused(const PlaceMatch& match, bool merge, const std::string& why);

  AtlasService& service_;
  const FusionOptions fusion_;
  const PoseGraphOptions pose_graph_;
  const Links links_;
  WorkLedger& ledger_;
  Bell bell_;
  Mutex mutex_;
  WeldingAgenda agenda_ GUARDED_BY(mutex_);
  std::jthread thread_;
};

}  // namespace pangaea
