#include "server/runtime/atlas_work.h"

#include <spdlog/spdlog.h>

#include <set>
#include <utility>

#include "common/place/vocabulary_file.h"
#include "server/atlas/map_economy.h"
#include "server/atlas/map_optimization.h"
#include "server/fusion/redundancy.h"
#include "server/runtime/stopwatch.h"

namespace pangaea {
Result<std::unique_ptr<AtlasWork>> AtlasWork::Create(AtlasService& service, const WorkOptions& options, Output output) {
  auto vocabulary = OpenVocabulary(options.vocabulary.string());
  if (!vocabulary) return Fail(vocabulary.error().code, "recognition.vocabulary: " + vocabulary.error().message);
  return std::unique_ptr<AtlasWork>(new AtlasWork(service, options, std::move(*vocabulary), std::move(output)));
}

AtlasWork::AtlasWork(AtlasService& service, const WorkOptions& options,
                     std::shared_ptr<const VocabularyTree> vocabulary, Output output)
    : service_(service),
      options_(options),
      output_(std::move(output)),
      vocabulary_(std::move(vocabulary)),
      ledger_(output_.progressed, [&service](WorkTime time) { service.Note(std::move(time)); }),
      separations_(service.separations()) {}

std::shared_ptr<AtlasWork::Team> AtlasWork::MakeTeam() {
  auto team = std::make_shared<Team>();
  Team* const raw = team.get();
  const auto optimize = [options = options_.map](const Atlas& atlas, MapId map, const LookedAtMap& before,
                                                 const std::stop_token& stop) {
    const Stopwatch watch;
    const double limit = 1e3 * options.bundle.max_seconds;
    const auto out_of_time = [&] { return limit > 0.0 && watch.milliseconds() > limit; };
    auto result = OptimizeMap(atlas, map, options, before, stop, out_of_time);
    if (!result) return std::optional<OptimizedMap>();
    const GlobalBundle& bundle = result->bundle;
    spdlog::info("map {}: {} duplicates fused in {} looks; {} observations, {} outliers, cost {:.4g}, {} steps",
                 ToString(map), result->fused, result->looks, bundle.observations, bundle.outliers, bundle.final_cost,
                 bundle.iterations);
    return std::optional(std::move(result->optimized));
  };
  const auto tidy = [options = options_](const IngestState& state, const std::stop_token& stop) {
    if (options.max_bytes == 0) return std::vector<MapEdit>();
    RedundancyOptions redundancy = options.redundancy;
    redundancy.max_bytes = options.max_bytes;
    return PlanCulling(state.atlas, KeyframesInUse(state, options.in_use), redundancy, stop);
  };
  const auto in_use = [options = options_](const IngestState& state) { return KeyframesInUse(state, options.in_use); };
  OptimizationThread::Economizer economize;
  if (options_.economy.enabled) {
    economize = [options = options_](const Atlas& atlas, MapId map, const std::set<KeyframeId>& used,
                                     const LookedAtMap& before, const std::stop_token& stop) {
      return EconomizeMap(atlas, map, used, options.economy, options.redundancy, before, stop);
    };
  }
  const auto finished = [raw] { raw->welding->Notify(); };
  team->optimization = std::make_unique<OptimizationThread>(
      service_, OptimizationThread::Jobs{optimize, tidy, in_use, economize}, options_.optimization, finished, ledger_);
  OptimizationThread& optimization = *team->optimization;
  const WeldingThread::Links links{
      output_.report, [&optimization](const WeldingPlan& plan) { optimization.Welded(plan.map, plan.absorbed); },
      [&optimization](MapId map) { return optimization.HoldsLoops(map); }};
  team->welding = std::make_unique<WeldingThread>(service_, options_.fusion, options_.pose_graph,
                                                  WeldingAgenda(options_.agenda, separations_), links, ledger_);
  const RecognitionThread::Links found{[raw](PlaceMatch match) { raw->welding->Add(std::move(match)); }, output_.answer,
                                       output_.report};
  team->recognition = std::make_unique<RecognitionThread>(
      service_, vocabulary_,
      RecognitionThread::Options{options_.place, options_.lookup, options_.frames, options_.compare_maps,
                                 options_.comparison, options_.comparisons, !std::exchange(started_, true)},
      found, ledger_);
  return team;
}

void AtlasWork::Start() {
  const std::shared_ptr<Team> team = MakeTeam();
  team->optimization->Start();
  team->welding->Start();
  team->recognition->Start();
  {
    MutexLock lock(mutex_);
    team_ = team;
  }
  Notify();
}

// Not under the mutex: the threads wait for the atlas thread, and that one notifies.
void AtlasWork::Stop() {
  std::shared_ptr<Team> team;
  {
    MutexLock lock(mutex_);
    team.swap(team_);
  }
  if (team == nullptr) return;
  team->recognition->RequestStop();
  team->welding->RequestStop();
  team->optimization->RequestStop();
  team->recognition->Stop();
  team->welding->Stop();
  team->optimization->Stop();
  // A later start looks at everything anew, and its versions of the atlas may be others.
  ledger_.Write([](WorkReport& report) {
    report.looked_up_version = report.planned_version = WorkReport::kNever;
    report.lookups_waiting = report.matches_waiting = report.optimizations_waiting = 0;
    report.welding = false;
    report.optimizing.reset();
  });
}

void AtlasWork::Separate(const Separations& maps) { separations_.insert(separations_.end(), maps.begin(), maps.end()); }

std::shared_ptr<AtlasWork::Team> AtlasWork::CurrentTeam() {
  MutexLock lock(mutex_);
  return team_;
}

void AtlasWork::Ask(PlaceQuestion question) {
  if (const auto team = CurrentTeam()) team->recognition->Ask(std::move(question));
}

void AtlasWork::Notify() {
  const std::shared_ptr<Team> team = CurrentTeam();
  if (team == nullptr) return;
  team->recognition->Notify();
  team->optimization->Notify();
}

}  // namespace pangaea
