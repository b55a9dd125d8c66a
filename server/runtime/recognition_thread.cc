#include "server/runtime/recognition_thread.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <optional>
#include <set>
#include <utility>

#include "server/map_comparison/map_comparison.h"
#include "server/runtime/stopwatch.h"
#include "server/runtime/thread_priority.h"
#include "server/runtime/unix_clock.h"

namespace pangaea {
namespace {

// Behind ingest and whatever agents run on the same machine, before bundle adjustment.
constexpr int kNice = 5;

}  // namespace

RecognitionThread::RecognitionThread(const AtlasService& service, std::shared_ptr<const VocabularyTree> vocabulary,
                                     const Options& options, Links links, WorkLedger& ledger)
    : service_(service),
      frames_(options.frames),
      place_(options.place),
      compares_(options.compare_maps),
      recovers_(options.recovers),
      comparison_(options.comparison),
      links_(std::move(links)),
      ledger_(ledger),
      recognizer_(std::move(vocabulary), options.place),
      agenda_(options.lookup),
      comparisons_(options.comparisons) {}

void RecognitionThread::Start() {
  if (recovers_) comparisons_.Recover(service_.State()->ingest.atlas);
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

void RecognitionThread::Stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void RecognitionThread::Ask(PlaceQuestion question) {
  {
    MutexLock lock(mutex_);
    (void)questions_.Put(std::move(question));
  }
  bell_.Ring();
}

void RecognitionThread::Run(const std::stop_token& stop) {
  StandBack(kNice);
  IndexRecovered(stop);
  while (bell_.Wait(stop)) {
    bool more = true;
    while (!stop.stop_requested() && more) {
      const bool answered = AnswerOne();
      more = LookUpOne() || CompareTwo() || answered;
    }
  }
}

// What was there when the server started enters the index before anything is looked up: a bag costs a fraction of a
// lookup, and what agents see now is recognised at once.
void RecognitionThread::IndexRecovered(const std::stop_token& stop) {
  const auto state = service_.State();
  state->ingest.atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    if (!stop.stop_requested()) recognizer_.Add(keyframe);
  });
}

bool RecognitionThread::LookUpOne() {
  const auto state = service_.State();
  const Atlas& atlas = state->ingest.atlas;
  TakeIn(state->ingest);
  const auto keyframe = agenda_.Next();
  ledger_.Write([&](WorkReport& report) { report.lookups_waiting = agenda_.waiting(); });
  if (!keyframe) return false;
  const Stopwatch watch;
  NoStageRecorder stages;
  PlaceRecognition recognition = recognizer_.Recognize(atlas, *keyframe, stages);
  const double milliseconds = watch.milliseconds();
  spdlog::debug("keyframe {} looked up in {:.1f} ms: {}", ToString(*keyframe), milliseconds,
                ToString(recognition.report.outcome));
  ledger_.Keep("recognition", watch);
  ledger_.Write([&](WorkReport& report) {
    report.recognition_ms.Add(milliseconds);
    report.recognized += recognition.matches.size();
  });
  if (recognition.report.outcome == PlaceOutcome::kFewLandmarks) agenda_.Defer(atlas, *keyframe);
  for (PlaceMatch& match : recognition.matches) links_.found(std::move(match));
  return true;
}

bool RecognitionThread::CompareTwo() {
  const auto state = service_.State();
  const Atlas& atlas = state->ingest.atlas;
  const auto maps = comparisons_.Next(atlas);
  if (!maps) {
    ledger_.Write([&](WorkReport& report) {
      report.looked_up_version = seen_version_;
      report.looked_up_living = seen_living_;
    });
    return false;
  }
  const Stopwatch watch;
  MapComparison comparison = CompareMaps(atlas, maps->first, maps->second, comparison_);
  spdlog::log(comparison.match ? spdlog::level::info : spdlog::level::debug, "maps {} and {} compared in {:.0f} ms: {}",
              ToString(maps->first), ToString(maps->second), watch.milliseconds(), Describe(comparison));
  ledger_.Keep("comparison", watch);
  if (comparison.match) links_.found(std::move(*comparison.match));
  return true;
}

bool RecognitionThread::AnswerOne() {
  std::optional<PlaceQuestion> question;
  {
    MutexLock lock(mutex_);
    question = questions_.Next();
  }
  if (!question) return false;
  const auto state = service_.State();
  if (const Status status = CheckQuestion(state->ingest, *question); !status) {
    Refuse(*question, status.error());
    return true;
  }
  TakeIn(state->ingest);
  const Stopwatch watch;
  const FrameLookup lookup = LookUpFrame(state->ingest.atlas, recognizer_.index(), recognizer_.vocabulary(),
                                         *question->request.frame, frames_, place_);
  Answer(*question, lookup, watch.milliseconds());
  return true;
}

void RecognitionThread::Refuse(const PlaceQuestion& question, const Error& error) {
  ReportFirst(AtlasEventKind::kRejected, question.request.session, "a request to be located: " + error.message);
}

void RecognitionThread::Answer(const PlaceQuestion& question, const FrameLookup& lookup, double milliseconds) {
  const RelocalizationRequest& request = question.request;
  RelocalizationAnswer answer;
  answer.session = request.session;
  answer.request = request.request;
  answer.found = lookup.is_found();
  std::string text = fmt::format("request {}: {}", request.request, ToString(lookup.outcome));
  if (lookup.is_found()) {
    answer.map = lookup.map;
    answer.reference = lookup.keyframe;
    answer.camera_from_reference = lookup.camera_from_keyframe;
    answer.inliers = static_cast<std::uint32_t>(lookup.inliers);
    text += fmt::format(" in map {}", ToString(lookup.map));
  }
  if (lookup.keyframe.valid()) {
    text +=
        fmt::format(" by keyframe {}: {} of {} landmarks agree, {} of {} parts of the image", ToString(lookup.keyframe),
                    lookup.inliers, lookup.found, lookup.confirmed_cells, lookup.expected_cells);
  }
  text += fmt::format("; {} candidates, {:.1f} ms", lookup.candidates, milliseconds);
  links_.answer(answer);
  ledger_.Write([&](WorkReport& report) {
    report.relocalization_ms.Add(milliseconds);
    ++(lookup.is_found() ? report.relocalized : report.not_relocalized);
  });
  ReportFirst(lookup.is_found() ? AtlasEventKind::kRelocalized : AtlasEventKind::kNotRelocalized, request.session,
              text);
}

void RecognitionThread::ReportFirst(AtlasEventKind kind, SessionId session, const std::string& text) {
  constexpr std::size_t kMostRemembered = 1000;  // a sender may invent sessions
  if (reported_.size() >= kMostRemembered) ForgetEnded();
  if (reported_.size() >= kMostRemembered && !reported_.contains(session)) return;
  const auto [before, is_new] = reported_.try_emplace(session, kind);
  if (!is_new && std::exchange(before->second, kind) == kind && kind != AtlasEventKind::kRelocalized) return;
  links_.report({service_.site(), kind, text, session, UnixNanoseconds()});
}

void RecognitionThread::ForgetEnded() {
  const auto state = service_.State();
  std::erase_if(reported_, [&](const auto& entry) {
    const auto session = state->ingest.sessions.find(entry.first);
    return session == state->ingest.sessions.end() || !session->second.alive();
  });
}

void RecognitionThread::TakeIn(const IngestState& state) {
  const std::size_t living = state.living();
  if (state.atlas.version() == seen_version_ && living == seen_living_) return;
  seen_version_ = state.atlas.version();
  seen_living_ = living;
  for (const KeyframeId id : agenda_.Update(state.atlas)) recognizer_.Remove(id);
  if (!compares_) return;
  const std::set<MapId> in_work = MapsInWork(state);
  comparisons_.Update(state.atlas, [&](MapId map) { return !in_work.contains(map); });
}

}  // namespace pangaea
