#include "server/runtime/atlas_jobs.h"

#include <gtest/gtest.h>

#include "tests/map/small_world.h"
#include "tests/server/flight.h"

namespace pangaea {
namespace {

using std::chrono_literals::operator""s;

InputJob Sent(Envelope envelope, ArrivalTime time = {}) {
  return {EnvelopeArrived{std::move(envelope), {1, 100}}, time};
}

InputJob Announced(const Flight& flight) { return {SessionAnnounced{flight.Announcement("hall"), {1, 100}}, {}}; }

// A proposal whose answer is written to `answer`.
ProposalJob Proposed(const std::string& kind, ProposalAnswer& answer) {
  return {{{kind}, {}}, [&answer](const ProposalAnswer& given) { answer = given; }};
}

TEST(AtlasJobs, EnvelopesAloneAreMeasuredFromTheirArrival) {
  Flight flight(kAnna);
  const Envelope envelope = flight.Next();
  const std::size_t bytes = envelope.edits.size();
  std::vector<AtlasJob> jobs;
  jobs.emplace_back(Announced(flight));
  jobs.emplace_back(Sent(envelope, ArrivalTime(7s)));
  jobs.emplace_back(TickJob{});
  EXPECT_EQ(EnvelopeArrivals(jobs), std::vector<ArrivalTime>{ArrivalTime(7s)});
  EXPECT_GT(bytes, 0U);
  EXPECT_EQ(BytesOf(jobs[0]), 0U);
  EXPECT_EQ(BytesOf(jobs[1]), bytes);
}

TEST(AtlasJobs, ARoundJudgesInputsInTheirOrder) {
  Flight flight(kAnna);
  std::vector<Envelope> envelopes;
  for (int i = 0; i < 3; ++i) envelopes.push_back(flight.Next());
  std::vector<AtlasJob> jobs;
  for (const int i : {0, 2, 1}) jobs.emplace_back(Sent(envelopes[static_cast<std::size_t>(i)]));
  IngestRound round(IngestState(), IngestOptions(), 0);
  MoveInto(round, jobs);
  const IngestOutcome outcome = std::move(round).Finish();
  ASSERT_EQ(outcome.acks.size(), 1U);
  EXPECT_EQ(outcome.acks[0].up_to, 2U) << "the third came too early, and only then the second";
}

TEST(AtlasJobs, WithoutAStoreItIsKnownStillWhoCame) {
  Flight flight(kAnna);
  std::vector<AtlasJob> jobs;
  ProposalAnswer answer;
  jobs.emplace_back(Announced(flight));
  jobs.emplace_back(Sent(flight.Next()));
  IngestRound refused(IngestState(), IngestOptions(), 0);
  MoveInto(refused, jobs);
  jobs.emplace_back(Proposed("tidying", answer));
  jobs.emplace_back(TickJob{});
  DropWhatNeedsAStore(jobs);
  ASSERT_EQ(jobs.size(), 1U);
  IngestRound round(IngestState(), IngestOptions(), 0);
  MoveInto(round, jobs);
  const IngestOutcome outcome = std::move(round).Finish();
  EXPECT_TRUE(outcome.state.sessions.contains(kAnna));
  EXPECT_EQ(outcome.state.position, 0U);
}

TEST(AtlasJobs, EachProposalGetsItsOwnAnswer) {
  ProposalAnswer first;
  ProposalAnswer second;
  std::vector<AtlasJob> jobs;
  jobs.emplace_back(Proposed("first", first));
  jobs.emplace_back(TickJob{});
  jobs.emplace_back(Proposed("second", second));
  AnswerProposals(jobs, {EditsTaken{{"first", 4}, 4, 1}, Fail(ErrorCode::kRefused, "it makes no sense any more")});
  ASSERT_TRUE(first);
  EXPECT_EQ(first->cause.Text(), "first 4");
  EXPECT_EQ(second.error().code, ErrorCode::kRefused);
  Decline(jobs, "the store is full");
  EXPECT_EQ(first.error().code, ErrorCode::kUnavailable);
  EXPECT_EQ(second.error().message, "the store is full");
}

TEST(AtlasJobs, UndosAreTakenOutAndTheOthersStay) {
  std::vector<AtlasJob> jobs;
  jobs.emplace_back(AckJob{});
  jobs.emplace_back(UndoJob{"merge 17", {}});
  jobs.emplace_back(TickJob{});
  jobs.emplace_back(UndoJob{"loop 20", {}});
  const std::vector<UndoJob> undos = TakeUndos(jobs);
  ASSERT_EQ(undos.size(), 2U);
  EXPECT_EQ(undos[0].cause, "merge 17");
  EXPECT_EQ(undos[1].cause, "loop 20");
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_TRUE(WantsAcks(jobs));
  EXPECT_FALSE(HasInput(jobs));
}

}  // namespace
}  // namespace pangaea
