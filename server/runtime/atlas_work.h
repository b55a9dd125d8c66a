#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "common/base/mutex.h"
#include "common/base/result.h"
#include "common/place/vocabulary_tree.h"
#include "server/runtime/atlas_service.h"
#include "server/runtime/optimization_thread.h"
#include "server/runtime/recognition_thread.h"
#include "server/runtime/welding_thread.h"
#include "server/runtime/work_options.h"
#include "server/runtime/work_report.h"

namespace pangaea {

// What the server does with the atlas by itself, each on a thread of its own: recognise places, weld what was
// recognised, optimise what was welded. All of it reads published states and proposes edits; none of it is waited for.
class AtlasWork {
 public:
  struct Output {
    std::function<void(const AtlasEvent&)> report;  // of what was refused; any thread
    std::function<void()> progressed;               // report() is another; any thread
    // To a lost agent; on the recognition thread.
    std::function<void(const RelocalizationAnswer&)> answer = [](const RelocalizationAnswer&) {};
  };
  // `service` outlives it. Errors: the vocabulary cannot be read.
  static Result<std::unique_ptr<AtlasWork>> Create(AtlasService& service, const WorkOptions& options, Output output);

  void Start();
  // Gives up what is under way. Before the service stops: what was proposed is still answered. May be started again.
  void Stop();
  // While it is stopped: these maps are not to be merged again.
  void Separate(const Separations& maps);
  // Any thread: there is a new state.
  void Notify();
  // Any thread: where was this frame taken? The answer comes through the output; see RecognitionThread::Ask.
  // While the work is stopped nobody answers: a lost agent asks again.
  void Ask(PlaceQuestion question);

  WorkReport report() const { return ledger_.Read(); }
  const VocabularyTree& vocabulary() const { return *vocabulary_; }

 private:
  AtlasWork(AtlasService& service, const WorkOptions& options, std::shared_ptr<const VocabularyTree> vocabulary,
            Output output);

  // The threads of one start. Each sends to the one before.
  struct Team {
    std::unique_ptr<OptimizationThread> optimization;
    std::unique_ptr<WeldingThread> welding;
    std::unique_ptr<RecognitionThread> recognition;
  };
  std::shared_ptr<Team> MakeTeam();
  std::shared_ptr<Team> CurrentTeam() EXCLUDES(mutex_);

  AtlasService& service_;
  const WorkOptions options_;
  const Output output_;
  const std::shared_ptr<const VocabularyTree> vocabulary_;
  WorkLedger ledger_;
  Separations separations_;
  bool started_ = false;  // before
  Mutex mutex_;
  std::shared_ptr<Team> team_ GUARDED_BY(mutex_);  // none while it is stopped
};

}  // namespace pangaea
