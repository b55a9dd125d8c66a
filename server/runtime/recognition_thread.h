#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <thread>

#include "common/place/vocabulary_tree.h"
#include "server/atlas/lookup_agenda.h"
#include "server/place_recognition/place_recognizer.h"
#include "server/runtime/atlas_service.h"
#include "server/runtime/bell.h"
#include "server/runtime/work_report.h"

namespace pangaea {

// Looks up each keyframe of the atlas once, whenever it comes, and hands on what it recognises. Its queue is the agenda
// over the newest published atlas: however many keyframes come at once, ingest never waits for it.
class RecognitionThread {
 public:
  using Found = std::function<void(PlaceMatch)>;
  // `service` and `ledger` outlive it. `found` is called on its thread.
  RecognitionThread(const AtlasService& service, std::shared_ptr<const VocabularyTree> vocabulary,
                    const PlaceRecognitionOptions& place, const LookupOptions& lookup, Found found, WorkLedger& ledger);
  ~RecognitionThread() { Stop(); }

  void Start();
  // Stop() in two steps: says that it is to end, so that others can be told meanwhile.
  void RequestStop() { thread_.request_stop(); }
  void Stop();
  // Any thread: there is a new atlas.
  void Notify() { bell_.Ring(); }

 private:
  void Run(const std::stop_token& stop);
  void IndexRecovered(const std::stop_token& stop);
  // False when there is nothing to look up.
  bool LookUpOne();
  void TakeIn(const Atlas& atlas);

  const AtlasService& service_;
  const Found found_;
  WorkLedger& ledger_;
  Bell bell_;
  // Of the thread.
  PlaceRecognizer recognizer_;
  LookupAgenda agenda_;
  std::uint64_t seen_version_ = 0;
  std::jthread thread_;
};

}  // namespace pangaea
