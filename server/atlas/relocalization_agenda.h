#pragma once

#include <cstddef>
#include <map>
#include <optional>

#include "common/wire/relocalization.h"
#include "server/ingest/ingest_round.h"

namespace pangaea {

// A lost agent's question, and who asked.
struct PlaceQuestion {
  RelocalizationRequest request;
  Sender sender;
};

// Which questions wait for an answer: of each session the newest alone, for an older frame says less about where the
// camera is now. Sessions take turns. Bounded: with too many sessions waiting a question of a further one is dropped;
// its agent asks again. A value without a thread.
class RelocalizationAgenda {
 public:
  static constexpr std::size_t kMostSessions = 64;  // a frame is about 50 kB

  // False when it was dropped.
  bool Put(PlaceQuestion question);
  std::optional<PlaceQuestion> Next();
  std::size_t waiting() const { return waiting_.size(); }

 private:
  std::map<SessionId, PlaceQuestion> waiting_;
  SessionId served_ = 0;  // whose turn it was
};

// Whether the question may be answered: only a living session's own agent, about a frame of its own kind of camera.
Status CheckQuestion(const IngestState& state, const PlaceQuestion& question);

}  // namespace pangaea
