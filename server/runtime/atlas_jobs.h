#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "common/base/result.h"
#include "server/ingest/ingest_round.h"
#include "server/storage/undo.h"

namespace pangaea {

using ArrivalTime = std::chrono::steady_clock::time_point;

// What the atlas thread is asked for. What is asked for while it works on a round makes the next one, in the same
// order.
struct InputJob {
  IngestInput input;
  ArrivalTime time;
};
struct ProposalJob {
  EditsProposed proposal;
  std::function<void(const ProposalAnswer&)> answer;
};
// The sizes in the state are to be measured anew, and a full store is to be tried again.
struct TickJob {};
// Every living session is to be told once more what it has acknowledged.
struct AckJob {};
struct QuotaJob {
  std::uint64_t max_bytes = 0;  // of the store
};
// Not part of a round: the atlas is another one afterwards.
struct UndoJob {
  std::string cause;
  std::function<void(const Result<UndoReport>&)> answer;
};
using AtlasJob = std::variant<InputJob, ProposalJob, TickJob, AckJob, QuotaJob, UndoJob>;

// Octets of edits in it; 0 for what is no envelope.
std::size_t BytesOf(const AtlasJob& job);
// When each of the envelopes came.
std::vector<ArrivalTime> EnvelopeArrivals(const std::vector<AtlasJob>& jobs);
bool HasInput(const std::vector<AtlasJob>& jobs);
bool WantsAcks(const std::vector<AtlasJob>& jobs);
// Takes the undos out of the jobs.
std::vector<UndoJob> TakeUndos(std::vector<AtlasJob>& jobs);
// Leaves what can be taken in without a store: who comes and goes.
void DropWhatNeedsAStore(std::vector<AtlasJob>& jobs);
// Gives inputs and proposals, in their order, to `round`. The jobs keep their answers, and all that
// DropWhatNeedsAStore leaves.
void MoveInto(IngestRound& round, std::vector<AtlasJob>& jobs);
// `answers`: one for each proposal among the jobs, in their order.
void AnswerProposals(const std::vector<AtlasJob>& jobs, const std::vector<ProposalAnswer>& answers);
// None of the proposals among the jobs is taken.
void Decline(const std::vector<AtlasJob>& jobs, const std::string& why);

}  // namespace pangaea
