#pragma once

#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>

#include "common/base/mutex.h"
#include "common/place/vocabulary_tree.h"
#include "common/wire/atlas_event.h"
#include "common/wire/relocalization.h"
#include "server/atlas/comparison_agenda.h"
#include "server/atlas/lookup_agenda.h"
#include "server/atlas/relocalization_agenda.h"
#include "server/map_comparison/map_comparison_options.h"
#include "server/place_recognition/frame_lookup.h"
#include "server/place_recognition/place_recognizer.h"
#include "server/runtime/atlas_service.h"
#include "server/runtime/bell.h"
#include "server/runtime/work_report.h"

namespace pangaea {

// Looks up each keyframe of the atlas once, whenever it comes, and hands on what it recognises. Its queue is the agenda
// over the newest published atlas: however many keyframes come at once, ingest never waits for it. Between two
// keyframes it answers one lost agent, so that neither waits for long. When all were looked up, it compares maps that
// none of them joined.
class RecognitionThread {
 public:
  struct Options {
    PlaceRecognitionOptions place;
    LookupOptions lookup;
    FrameLookupOptions frames;
    bool compare_maps = true;
    MapComparisonOptions comparison;
    ComparisonAgendaOptions comparisons;
    // The maps that are there when it starts come from the store, and not from a stop of the work.
    bool recovers = true;
  };
  // Called on its thread.
  struct Links {
    std::function<void(PlaceMatch)> found;
    std::function<void(const RelocalizationAnswer&)> answer;
    std::function<void(const AtlasEvent&)> report;
  };
  // `service` and `ledger` outlive it.
  RecognitionThread(const AtlasService& service, std::shared_ptr<const VocabularyTree> vocabulary,
                    const Options& options, Links links, WorkLedger& ledger);
  ~RecognitionThread() { Stop(); }

  void Start();
  // Stop() in two steps: says that it is to end, so that others can be told meanwhile.
  void RequestStop() { thread_.request_stop(); }
  void Stop();
  // Any thread: there is a new atlas.
  void Notify() { bell_.Ring(); }
  // Any thread: a lost agent's question. Of one session the newest alone is answered (RelocalizationAgenda); those that
  // may not be are refused with an event.
  void Ask(PlaceQuestion question) EXCLUDES(mutex_);

 private:
  void Run(const std::stop_token& stop);
  void IndexRecovered(const std::stop_token& stop);
  // False when there is nothing to look up.
  bool LookUpOne();
  // False when all maps were compared.
  bool CompareTwo();
  // False when nobody asks.
  bool AnswerOne() EXCLUDES(mutex_);
  void Refuse(const PlaceQuestion& question, const Error& error);
  void Answer(const PlaceQuestion& question, const FrameLookup& lookup, double milliseconds);
  // The first of a kind in a row: an agent that stays lost asks several times a second.
  void ReportFirst(AtlasEventKind kind, SessionId session, const std::string& text);
  // Of what was reported, sessions that are over or never were.
  void ForgetEnded();
  void TakeIn(const IngestState& state);

  const AtlasService& service_;
  const FrameLookupOptions frames_;
  const PlaceRecognitionOptions place_;
  const bool compares_;
  const bool recovers_;
  const MapComparisonOptions comparison_;
  const Links links_;
  WorkLedger& ledger_;
  Bell bell_;
  Mutex mutex_;
  RelocalizationAgenda questions_ GUARDED_BY(mutex_);
  // Of the thread.
  PlaceRecognizer recognizer_;
  LookupAgenda agenda_;
  ComparisonAgenda comparisons_;
  std::uint64_t seen_version_ = 0;
  std::size_t seen_living_ = 0;
  std::map<SessionId, AtlasEventKind> reported_;  // the latest of each session
  std::jthread thread_;
};

}  // namespace pangaea
