#include "server/runtime/recognition_thread.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "server/runtime/stopwatch.h"
#include "server/runtime/thread_priority.h"

namespace pangaea {
namespace {

// Behind ingest and whatever agents run on the same machine, before bundle adjustment.
constexpr int kNice = 5;

}  // namespace

RecognitionThread::RecognitionThread(const AtlasService& service, std::shared_ptr<const VocabularyTree> vocabulary,
                                     const PlaceRecognitionOptions& place, const LookupOptions& lookup, Found found,
                                     WorkLedger& ledger)
    : service_(service),
      found_(std::move(found)),
      ledger_(ledger),
      recognizer_(std::move(vocabulary), place),
      agenda_(lookup) {}

void RecognitionThread::Start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

void RecognitionThread::Stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void RecognitionThread::Run(const std::stop_token& stop) {
  StandBack(kNice);
  IndexRecovered(stop);
  while (bell_.Wait(stop)) {
    while (!stop.stop_requested() && LookUpOne()) {
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
  TakeIn(atlas);
  const auto keyframe = agenda_.Next();
  ledger_.Write([&](WorkReport& report) {
    report.lookups_waiting = agenda_.waiting();
    if (!keyframe) report.looked_up_version = seen_version_;
  });
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
  for (PlaceMatch& match : recognition.matches) found_(std::move(match));
  return true;
}

void RecognitionThread::TakeIn(const Atlas& atlas) {
  if (atlas.version() == seen_version_) return;
  seen_version_ = atlas.version();
  for (const KeyframeId id : agenda_.Update(atlas)) recognizer_.Remove(id);
}

}  // namespace pangaea
