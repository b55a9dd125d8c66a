#include <gtest/gtest.h>

#include <deque>
#include <random>

#include "agent/uplink/retained_edits.h"
#include "tests/agent/spill_map.h"

namespace pangaea {
namespace {

using std::chrono_literals::operator""ms;
using Time = RetainedEdits::Time;

constexpr SessionId kSession = 9;

Envelope EnvelopeOf(std::uint64_t sequence, std::size_t bytes = 100) {
  Envelope envelope;
  envelope.session = kSession;
  envelope.sequence = sequence;
  envelope.edits.resize(bytes);
  return envelope;
}

using testing::SpillMap;

std::uint64_t SendAll(RetainedEdits& retained, Time now) {
  std::uint64_t count = 0;
  while (auto envelope = retained.NextToSend().value()) {
    retained.OnSent(envelope->sequence, now);
    ++count;
  }
  return count;
}

TEST(RetainedEdits, NothingIsSentWithoutAServer) {
  RetainedEdits retained({}, nullptr);
  ASSERT_TRUE(retained.Retain(EnvelopeOf(1)));
  EXPECT_EQ(SendAll(retained, Time()), 0U);
  retained.OnServerPresent(true);
  EXPECT_EQ(SendAll(retained, Time()), 1U);
}

TEST(RetainedEdits, TheWindowHoldsBackWhatIsNotAcknowledgedYet) {
  RetainedEdits retained({.in_flight_bytes = 250}, nullptr);
  retained.OnServerPresent(true);
  for (std::uint64_t i = 1; i <= 5; ++i) ASSERT_TRUE(retained.Retain(EnvelopeOf(i)));
  EXPECT_EQ(SendAll(retained, Time()), 2U);
  retained.OnAck({kSession, 1, 7, {}}, Time());
  EXPECT_EQ(SendAll(retained, Time()), 1U);
  retained.OnAck({kSession, 3, 7, {}}, Time());
  EXPECT_EQ(SendAll(retained, Time()), 2U);
}

TEST(RetainedEdits, AnEnvelopeLargerThanTheWindowTravelsAlone) {
  RetainedEdits retained({.in_flight_bytes = 250}, nullptr);
  retained.OnServerPresent(true);
  ASSERT_TRUE(retained.Retain(EnvelopeOf(1, 1000)));
  ASSERT_TRUE(retained.Retain(EnvelopeOf(2, 1000)));
  EXPECT_EQ(SendAll(retained, Time()), 1U);
}

TEST(RetainedEdits, ANewIncarnationGoesBackToTheLastAck) {
  RetainedEdits retained({}, nullptr);
  retained.OnServerPresent(true);
  for (std::uint64_t i = 1; i <= 5; ++i) ASSERT_TRUE(retained.Retain(EnvelopeOf(i)));
  SendAll(retained, Time());
  retained.OnAck({kSession, 2, 7, {}}, Time());
  retained.OnAck({kSession, 2, 8, {}}, Time());
  EXPECT_EQ(retained.NextToSend().value()->sequence, 3U);
  EXPECT_EQ(retained.resends(), 1U);
}

TEST(RetainedEdits, SilenceGoesBackWithDoublingPatience) {
  RetainedEdits retained({.first_timeout = 100ms, .last_timeout = 300ms}, nullptr);
  retained.OnServerPresent(true);
  ASSERT_TRUE(retained.Retain(EnvelopeOf(1)));
  Time now;
  for (const auto patience : {100ms, 200ms, 300ms, 300ms}) {
    ASSERT_EQ(SendAll(retained, now), 1U);
    EXPECT_EQ(retained.deadline(), now + patience);
    EXPECT_FALSE(retained.OnTime(now + patience - 1ms));
    now += patience;
    EXPECT_TRUE(retained.OnTime(now));
  }
  SendAll(retained, now);
  retained.OnAck({kSession, 1, 7, {}}, now);
  EXPECT_FALSE(retained.deadline());
}

TEST(RetainedEdits, BeyondTheMemoryLimitEnvelopesAreSpilledAndReadBackInOrder) {
  SpillMap spill;
  RetainedEdits retained({.memory_bytes = 350}, &spill);
  for (std::uint64_t i = 1; i <= 10; ++i) ASSERT_TRUE(retained.Retain(EnvelopeOf(i)));
  EXPECT_EQ(retained.memory_bytes(), 300U);
  EXPECT_EQ(spill.envelopes.size(), 7U);
  retained.OnServerPresent(true);
  EXPECT_EQ(SendAll(retained, Time()), 10U);
  retained.OnAck({kSession, 10, 7, {}}, Time());
  EXPECT_TRUE(retained.all_acknowledged());
  EXPECT_TRUE(spill.envelopes.empty());
  EXPECT_EQ(retained.memory_bytes(), 0U);
}

TEST(RetainedEdits, AFullDiskIsToldAndTheEnvelopeStaysInMemory) {
  SpillMap spill;
  spill.full = true;
  RetainedEdits retained({.memory_bytes = 100}, &spill);
  ASSERT_TRUE(retained.Retain(EnvelopeOf(1)));
  EXPECT_FALSE(retained.Retain(EnvelopeOf(2)));
  retained.OnServerPresent(true);
  EXPECT_EQ(SendAll(retained, Time()), 2U);
}

TEST(RetainedEdits, EachRejectionIsReportedOnce) {
  RetainedEdits retained({}, nullptr);
  retained.OnServerPresent(true);
  for (std::uint64_t i = 1; i <= 3; ++i) ASSERT_TRUE(retained.Retain(EnvelopeOf(i)));
  SendAll(retained, Time());
  const EditAck ack{kSession, 2, 7, {{2, RejectionReason::kUnknownReference, "landmark 5"}}};
  EXPECT_EQ(retained.OnAck(ack, Time()), ack.rejections);
  EXPECT_TRUE(retained.OnAck(ack, Time()).empty());
}

TEST(RetainedEdits, AnAckOfWhatWasNeverMadeIsIgnored) {
  RetainedEdits retained({}, nullptr);
  retained.OnServerPresent(true);
  ASSERT_TRUE(retained.Retain(EnvelopeOf(1)));
  retained.OnAck({kSession, 1000, 7, {}}, Time());
  EXPECT_EQ(retained.acknowledged(), 0U);
}

// A server as the wire's rules want it: takes n+1 alone, acks cumulatively, keeps what it acked across restarts.
struct ModelServer {
  std::uint64_t incarnation = 1;
  std::vector<std::uint64_t> durable;
  std::uint64_t volatile_up_to = 0;  // taken, not committed: lost by a crash

  void Take(std::uint64_t sequence) {
    if (sequence == volatile_up_to + 1) ++volatile_up_to;
  }
  EditAck Commit() {
    while (durable.size() < volatile_up_to) durable.push_back(durable.size() + 1);
    return {kSession, durable.size(), incarnation, {}};
  }
  void Crash() {
    volatile_up_to = durable.size();
    ++incarnation;
  }
};

class RetainedEditsOnABadLink : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(RetainedEditsOnABadLink, TheServerGetsEachSequenceOnceAndInOrder) {
  std::mt19937_64 random(GetParam());
  const auto chance = [&](int percent) { return static_cast<int>(random() % 100) < percent; };
  SpillMap spill;
  RetainedEdits retained({.memory_bytes = 1000, .in_flight_bytes = 800}, &spill);
  retained.OnServerPresent(true);
  ModelServer server;
  std::deque<std::uint64_t> to_server;
  std::deque<EditAck> to_agent;
  Time now;
  constexpr std::uint64_t kCount = 200;
  const auto put = [&](auto& link, const auto& item) {
    if (chance(15)) return;                                     // lost
    link.insert(chance(20) ? link.begin() : link.end(), item);  // reordered
    if (chance(15)) link.push_back(item);                       // duplicated
  };
  std::size_t rounds = 0;
  for (; server.durable.size() < kCount || !retained.all_acknowledged(); ++rounds) {
    ASSERT_LT(rounds, 200000U);
    now += 50ms;
    if (retained.last_sequence() < kCount && chance(30)) {
      ASSERT_TRUE(retained.Retain(EnvelopeOf(retained.next_sequence())));
    }
    if (chance(80)) {
      if (const auto envelope = retained.NextToSend().value()) {
        put(to_server, envelope->sequence);
        retained.OnSent(envelope->sequence, now);
      }
    }
    if (!to_server.empty() && chance(60)) {
      server.Take(to_server.front());
      to_server.pop_front();
    }
    if (chance(30)) put(to_agent, server.Commit());
    if (chance(1)) server.Crash();
    if (!to_agent.empty() && chance(60)) {
      retained.OnAck(to_agent.front(), now);
      to_agent.pop_front();
    }
    if (chance(1)) {
      retained.OnServerPresent(false);
      retained.OnServerPresent(true);
    }
    retained.OnTime(now);
    ASSERT_LE(retained.acknowledged(), server.durable.size());
  }
  ASSERT_EQ(server.durable.size(), kCount);
  for (std::uint64_t i = 0; i < kCount; ++i) EXPECT_EQ(server.durable[i], i + 1);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RetainedEditsOnABadLink, ::testing::Range<std::uint64_t>(1, 51));

TEST(RetainedEdits, WhatASpillSinkThatFillsUpDidNotTakeStaysInMemory) {
  SpillMap spill;
  RetainedEdits retained({}, &spill);
  for (std::uint64_t i = 1; i <= 3; ++i) ASSERT_TRUE(retained.Retain(EnvelopeOf(i)));
  spill.full = true;
  EXPECT_FALSE(retained.SpillAll());
  EXPECT_EQ(retained.memory_bytes(), 300U);
  spill.full = false;
  EXPECT_TRUE(retained.SpillAll());
  EXPECT_EQ(retained.memory_bytes(), 0U);
  EXPECT_EQ(spill.envelopes.size(), 3U);
  retained.OnServerPresent(true);
  EXPECT_EQ(SendAll(retained, Time()), 3U) << "from the sink";
}

}  // namespace
}  // namespace pangaea
