#include <gtest/gtest.h>

#include <chrono>

#include "common/base/bounded_queue.h"
#include "common/dds/reader.h"
#include "common/dds/waiter.h"
#include "common/dds/writer.h"
#include "tests/dds/two_processes.h"

namespace pangaea {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

// A reader whose samples and matches end up in queues that a test can wait for.
template <typename Value>
class Inbox {
 public:
  explicit Inbox(const Participant& participant)
      : reader_(Reader<Value>::Open(participant).value()), waiter_(Waiter::Create(participant).value()) {
    EXPECT_TRUE(waiter_->OnSample<Value>(
        reader_, [this](Sample<Value> sample) { EXPECT_TRUE(samples_.Push(std::move(sample))); }));
    EXPECT_TRUE(waiter_->OnMatch(reader_, [this](const MatchChange& change) { matches_.PushNewest(change); }));
    waiter_->Start();
  }

  Sample<Value> Next() { return samples_.Pop().value(); }
  void WaitForWriters(std::uint32_t count) {
    while (matches_.Pop().value().current != count) {
    }
  }
  std::size_t waiting() const { return samples_.size(); }
  Reader<Value>& reader() { return reader_; }

 private:
  BoundedQueue<Sample<Value>> samples_{100000};
  BoundedQueue<MatchChange> matches_{100};
  Reader<Value> reader_;
  std::unique_ptr<Waiter> waiter_;
};

// Waits until a writer has as many readers.
class Matched {
 public:
  Matched(const Participant& participant, const WriterBase& writer) : waiter_(Waiter::Create(participant).value()) {
    EXPECT_TRUE(waiter_->OnMatch(writer, [this](const MatchChange& change) { changes_.PushNewest(change); }));
    waiter_->Start();
  }
  void WaitFor(std::uint32_t count) {
    while (changes_.Pop().value().current != count) {
    }
  }

 private:
  BoundedQueue<MatchChange> changes_{100};
  std::unique_ptr<Waiter> waiter_;
};

TEST(Dds, EnvelopesArriveOverTheNetworkOnceAndInOrder) {
  TestNode agent(1);
  TestNode server(2);
  Inbox<Envelope> inbox(server.participant);
  auto writer = Writer<Envelope>::Open(agent.participant).value();
  Matched matched(agent.participant, writer);
  matched.WaitFor(1);
  Envelope envelope = MakeEnvelope(5, 1, 0, {});
  envelope.edits.assign(150'000, std::byte{7});
  for (envelope.sequence = 1; envelope.sequence <= 100; ++envelope.sequence) ASSERT_TRUE(writer.Write(envelope));
  EXPECT_TRUE(writer.WaitForAcks(10s));
  for (std::uint64_t sequence = 1; sequence <= 100; ++sequence) {
    const Sample<Envelope> sample = inbox.Next();
    ASSERT_TRUE(sample.alive);
    ASSERT_EQ(sample.value.sequence, sequence);
    ASSERT_EQ(sample.value.edits, envelope.edits);
  }
  EXPECT_EQ(inbox.waiting(), 0U);
}

TEST(Dds, ALateReaderGetsTheLastAnnouncementOfEachSession) {
  TestNode agent(1);
  TestNode server(2);
  auto writer = Writer<SessionAnnouncement>::Open(agent.participant).value();
  SessionAnnouncement session;
  session.session = 5;
  session.ideal_camera = {752, 480, 458, 457, 367, 248, 0.11};
  session.name = "old";
  ASSERT_TRUE(writer.Write(session));
  session.name = "new";
  ASSERT_TRUE(writer.Write(session));
  Inbox<SessionAnnouncement> inbox(server.participant);
  EXPECT_EQ(inbox.Next().value.name, "new");
}

TEST(Dds, AWritersEndIsToldWithTheKeyOfItsSession) {
  TestNode agent(1);
  TestNode server(2);
  Inbox<SessionAnnouncement> inbox(server.participant);
  PublicationHandle publication = 0;
  {
    auto writer = Writer<SessionAnnouncement>::Open(agent.participant).value();
    SessionAnnouncement session;
    session.session = 5;
    session.ideal_camera = {752, 480, 458, 457, 367, 248, 0.11};
    ASSERT_TRUE(writer.Write(session));
    const auto first = inbox.Next();
    EXPECT_TRUE(first.alive);
    publication = first.publication;
    EXPECT_EQ(inbox.reader().MatchedPublications(), std::vector<PublicationHandle>{publication});
    EXPECT_NE(inbox.reader().ParticipantOf(publication), 0U);
  }
  const auto last = inbox.Next();
  EXPECT_FALSE(last.alive);
  EXPECT_EQ(last.value.session, 5U);
  EXPECT_EQ(last.publication, publication);
  inbox.WaitForWriters(0);
  EXPECT_TRUE(inbox.reader().MatchedPublications().empty());
}

TEST(Dds, TwoWritersOfOneSessionAreToldApart) {
  TestNode agent(1);
  TestNode impostor(3);
  TestNode server(2);
  Inbox<Envelope> inbox(server.participant);
  auto first = Writer<Envelope>::Open(agent.participant).value();
  auto second = Writer<Envelope>::Open(impostor.participant).value();
  inbox.WaitForWriters(2);
  Matched first_matched(agent.participant, first);
  first_matched.WaitFor(1);
  Matched second_matched(impostor.participant, second);
  second_matched.WaitFor(1);
  ASSERT_TRUE(first.Write(MakeEnvelope(5, 1, 0, {})));
  const auto from_first = inbox.Next();
  ASSERT_TRUE(second.Write(MakeEnvelope(5, 1, 0, {})));
  const auto from_second = inbox.Next();
  EXPECT_NE(from_first.publication, from_second.publication);
  EXPECT_NE(inbox.reader().ParticipantOf(from_first.publication),
            inbox.reader().ParticipantOf(from_second.publication));
}

TEST(Dds, SitesDoNotHearEachOther) {
  TestNode other(1, "attic");
  TestNode same(3, "hall");
  TestNode server(2, "hall");
  Inbox<SessionAnnouncement> inbox(server.participant);
  SessionAnnouncement session;
  session.ideal_camera = {752, 480, 458, 457, 367, 248, 0.11};
  auto foreign = Writer<SessionAnnouncement>::Open(other.participant).value();
  session.session = 1;
  ASSERT_TRUE(foreign.Write(session));
  auto own = Writer<SessionAnnouncement>::Open(same.participant).value();
  session.session = 2;
  ASSERT_TRUE(own.Write(session));
  EXPECT_EQ(inbox.Next().value.session, 2U);
  EXPECT_EQ(inbox.reader().MatchedPublications().size(), 1U);
  EXPECT_EQ(inbox.waiting(), 0U);
}

TEST(Dds, AWriterWhosePeerFallsSilentIsToldSoAndCanGoOnLater) {
  TestNode agent(1);
  TestNode server(2);
  Inbox<Envelope> inbox(server.participant);
  auto writer = Writer<Envelope>::Open(agent.participant, {.max_blocking_time = 50ms}).value();
  Matched matched(agent.participant, writer);
  matched.WaitFor(1);
  server.domain.SetLinkDown(true);
  Envelope envelope = MakeEnvelope(5, 1, 0, {});
  envelope.edits.assign(200'000, std::byte{7});
  Status status;
  std::uint64_t written = 0;
  while (status && written < 1000) {
    envelope.sequence = written + 1;
    status = writer.Write(envelope);
    if (status) ++written;
  }
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kUnavailable);
  EXPECT_FALSE(writer.WaitForAcks(10ms));
  server.domain.SetLinkDown(false);
  for (std::uint64_t sequence = 1; sequence <= written; ++sequence) ASSERT_EQ(inbox.Next().value.sequence, sequence);
}

TEST(Dds, ASampleWithImpossibleNumbersIsReportedAndLeftOut) {
  TestNode agent(1);
  TestNode server(2);
  BoundedQueue<Error> refused(10);
  BoundedQueue<SessionId> taken(10);
  auto reader = Reader<SessionAnnouncement>::Open(server.participant).value();
  auto waiter = Waiter::Create(server.participant).value();
  ASSERT_TRUE(waiter->OnSample<SessionAnnouncement>(
      reader, [&](Sample<SessionAnnouncement> sample) { taken.PushNewest(sample.value.session); },
      [&](const Error& error) { refused.PushNewest(error); }));
  waiter->Start();
  auto writer = Writer<SessionAnnouncement>::Open(agent.participant).value();
  SessionAnnouncement session;  // its camera has no size
  session.session = 1;
  ASSERT_TRUE(writer.Write(session));
  EXPECT_EQ(refused.Pop()->code, ErrorCode::kInvalidArgument);
  session.ideal_camera = {752, 480, 458, 457, 367, 248, 0.11};
  ASSERT_TRUE(writer.Write(session));
  EXPECT_EQ(taken.Pop(), 1U);
  waiter->Stop();
}

TEST(Dds, StoppingAWaiterThatWasNeverStartedOrTwiceIsHarmless) {
  TestNode node(1);
  auto waiter = Waiter::Create(node.participant).value();
  waiter->Stop();
  waiter->Start();
  waiter->Stop();
  waiter->Stop();
}

}  // namespace
}  // namespace pangaea
