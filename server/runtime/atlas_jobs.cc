#include "server/runtime/atlas_jobs.h"

#include <algorithm>
#include <utility>

namespace pangaea {
namespace {

// The envelope that came with the job, if one did.
const EnvelopeArrived* EnvelopeIn(const AtlasJob& job) {
  const auto* input = std::get_if<InputJob>(&job);
  return input == nullptr ? nullptr : std::get_if<EnvelopeArrived>(&input->input);
}

}  // namespace

std::size_t BytesOf(const AtlasJob& job) {
  const EnvelopeArrived* envelope = EnvelopeIn(job);
  return envelope == nullptr ? 0 : envelope->envelope.edits.size();
}

std::vector<ArrivalTime> EnvelopeArrivals(const std::vector<AtlasJob>& jobs) {
  std::vector<ArrivalTime> arrivals;
  for (const AtlasJob& job : jobs) {
    if (EnvelopeIn(job) != nullptr) arrivals.push_back(std::get<InputJob>(job).time);
  }
  return arrivals;
}

bool HasInput(const std::vector<AtlasJob>& jobs) {
  return std::ranges::any_of(jobs, [](const AtlasJob& job) {
    return std::holds_alternative<InputJob>(job) || std::holds_alternative<ProposalJob>(job);
  });
}

bool WantsAcks(const std::vector<AtlasJob>& jobs) {
  return std::ranges::any_of(jobs, [](const AtlasJob& job) { return std::holds_alternative<AckJob>(job); });
}

std::vector<UndoJob> TakeUndos(std::vector<AtlasJob>& jobs) {
  std::vector<UndoJob> undos;
  for (AtlasJob& job : jobs) {
    if (auto* undo = std::get_if<UndoJob>(&job)) undos.push_back(std::move(*undo));
  }
  std::erase_if(jobs, [](const AtlasJob& job) { return std::holds_alternative<UndoJob>(job); });
  return undos;
}

void DropWhatNeedsAStore(std::vector<AtlasJob>& jobs) {
  std::erase_if(
      jobs, [](const AtlasJob& job) { return !std::holds_alternative<InputJob>(job) || EnvelopeIn(job) != nullptr; });
}

void MoveInto(IngestRound& round, std::vector<AtlasJob>& jobs) {
  for (AtlasJob& job : jobs) {
    if (auto* input = std::get_if<InputJob>(&job)) {
      std::visit([&round](auto&& arrived) { round.Take(std::move(arrived)); }, std::move(input->input));
    } else if (auto* proposed = std::get_if<ProposalJob>(&job)) {
      round.Take(std::move(proposed->proposal));
    }
  }
}

void AnswerProposals(const std::vector<AtlasJob>& jobs, const std::vector<ProposalAnswer>& answers) {
  auto answer = answers.begin();
  for (const AtlasJob& job : jobs) {
    if (const auto* proposed = std::get_if<ProposalJob>(&job)) proposed->answer(*answer++);
  }
}

void Decline(const std::vector<AtlasJob>& jobs, const std::string& why) {
  for (const AtlasJob& job : jobs) {
    if (const auto* proposed = std::get_if<ProposalJob>(&job)) proposed->answer(Fail(ErrorCode::kUnavailable, why));
  }
}

}  // namespace pangaea
