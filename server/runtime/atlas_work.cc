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
    : vocabulary_(std::move(vocabulary)),
      ledger_(std::move(output.progressed), [&service](WorkTime time) { service.Note(std::move(time)); }) {
  const auto optimize = [options = options.map](const Atlas& atlas, MapId map, const std::stop_token& stop) {
    const Stopwatch watch;
    const double limit = 1e3 * options.bundle.max_seconds;
    const auto out_of_time = [&] { return limit > 0.0 && watch.milliseconds() > limit; };
    auto result = OptimizeMap(atlas, map, options, stop, out_of_time);
    if (!result) return std::optional<OptimizedMap>();
    const GlobalBundle& bundle = result->bundle;
    spdlog::info("map {}: {} duplicates fused; {} observations, {} outliers, cost {:.4g} to {:.4g}, {} steps",
                 ToString(map), result->fused, bundle.observations, bundle.outliers, bundle.initial_cost,
                 bundle.final_cost, bundle.iterations);
    return std::optional(std::move(result->optimized));
  };
  const auto tidy = [options](const IngestState& state, const std::stop_token& stop) {
    if (options.max_bytes == 0) return std::vector<MapEdit>();
    RedundancyOptions redundancy = options.redundancy;
    redundancy.max_bytes = options.max_bytes;
    return PlanCulling(state.atlas, KeyframesInUse(state, options.in_use), redundancy, stop);
  };
  const auto in_use = [options](const IngestState& state) { return KeyframesInUse(state, options.in_use); };
  OptimizationThread::Economizer economize;
  if (options.economy.enabled) {
    economize = [options](const Atlas& atlas, MapId map, const std::set<KeyframeId>& used,
                          const std::stop_token& stop) {
      return EconomizeMap(atlas, map, used, options.economy, options.redundancy, stop);
    };
  }
  const auto finished = [this] { welding_->Notify(); };
  optimization_ = std::make_unique<OptimizationThread>(
      service, OptimizationThread::Jobs{optimize, tidy, in_use, economize}, options.optimization, finished, ledger_);
  OptimizationThread& optimization = *optimization_;
  const WeldingThread::Links links{
      output.report, [&optimization](const WeldingPlan& plan) { optimization.Welded(plan.map, plan.absorbed); },
      [&optimization](MapId map) { return optimization.HoldsLoops(map); }};
  welding_ = std::make_unique<WeldingThread>(service, options.fusion, options.pose_graph,
                                             WeldingAgenda(options.agenda, service.separations()), links, ledger_);
  const RecognitionThread::Links found{[this](PlaceMatch match) { welding_->Add(std::move(match)); },
                                       std::move(output.answer), std::move(output.report)};
  recognition_ = std::make_unique<RecognitionThread>(
      service, vocabulary_, RecognitionThread::Options{options.place, options.lookup, options.frames}, found, ledger_);
}

void AtlasWork::Start() {
  optimization_->Start();
  welding_->Start();
  recognition_->Start();
  Notify();
}

void AtlasWork::Stop() {
  recognition_->RequestStop();
  welding_->RequestStop();
  optimization_->RequestStop();
  recognition_->Stop();
  welding_->Stop();
  optimization_->Stop();
}

void AtlasWork::Notify() {
  recognition_->Notify();
  optimization_->Notify();
}

}  // namespace pangaea
