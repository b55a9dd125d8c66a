#include "agent/runtime/downlink.h"

#include <gtest/gtest.h>

#include <thread>

#include "tests/agent/uplink_random_history.h"

namespace pangaea {
namespace {

constexpr SessionId kSession = RandomHistory::kSession;

AgentCorrection Correction(std::uint64_t version, std::uint64_t acknowledged) {
  return {kSession, 1, version, acknowledged, {}};
}

class DownlinkTest : public testing::Test {
 protected:
  void Receive(const AgentCorrection& correction) {
    for (CorrectionPart& part : SplitCorrection(correction)) {
      ASSERT_TRUE(downlink_.Receive(std::move(part), stream_));
    }
  }
  // The agent sends an envelope, and the server acknowledges it.
  void SendOne() {
    agent_.Step();
    const std::vector<MapEdit> edits = agent_.Take();
    ASSERT_TRUE(stream_.Take(std::make_shared<const Atlas>(agent_.atlas()), edits, PlanKind::kFlush));
    ASSERT_TRUE(stream_.OnAck({kSession, stream_.retained().last_sequence(), 1, {}}, {}).empty());
  }

  RandomHistory agent_{3};
  EditStream stream_{kSession, {}, nullptr};
  Downlink downlink_;
};

TEST_F(DownlinkTest, ACorrectionIsOfferedWhenTheAcksAreAsFarAsItsMaking) {
  Receive(Correction(5, 1));
  downlink_.Offer(stream_);
  EXPECT_FALSE(downlink_.Take());
  SendOne();
  ASSERT_GE(stream_.retained().acknowledged(), 1U);
  downlink_.Offer(stream_);
  const auto ready = downlink_.Take();
  ASSERT_TRUE(ready);
  EXPECT_EQ(ready->correction->version, 5U);
  EXPECT_FALSE(downlink_.Take());
}

TEST_F(DownlinkTest, TheNextIsOfferedOnceTheFirstIsAbsorbed) {
  Receive(Correction(5, 0));
  Receive(Correction(6, 0));
  downlink_.Offer(stream_);
  const auto first = downlink_.Take();
  ASSERT_TRUE(first);
  downlink_.Offer(stream_);
  EXPECT_FALSE(downlink_.Take());
  stream_.Absorb(*first->correction);
  downlink_.OnAbsorbed(stream_.version());
  downlink_.Offer(stream_);
  const auto second = downlink_.Take();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->correction->version, 6U);
}

TEST_F(DownlinkTest, AnOlderOneThanWasAbsorbedIsIgnored) {
  stream_.Absorb(Correction(6, 0));
  downlink_.OnAbsorbed(stream_.version());
  Receive(Correction(5, 0));
  downlink_.Offer(stream_);
  EXPECT_FALSE(downlink_.Take());
}

TEST_F(DownlinkTest, WaitingEndsWhenNothingMoreIsToCome) {
  const auto never = Downlink::Time::max();
  EXPECT_FALSE(downlink_.Await(never));  // the server said nothing of corrections
  downlink_.OnAck({kSession, 0, 1, {}, 5, true});
  std::thread server([this] {
    downlink_.OnAck({kSession, 0, 1, {}, 5, false});
    Receive(Correction(5, 0));
    downlink_.Offer(stream_);
  });
  EXPECT_TRUE(downlink_.Await(never));
  server.join();
  ASSERT_TRUE(downlink_.Take());
  downlink_.OnAbsorbed(5);
  EXPECT_FALSE(downlink_.Await(never));
}

TEST_F(DownlinkTest, WaitingEndsWhenTheServerAgreesWithTheNewestClaim) {
  downlink_.OnClaim(2);
  downlink_.OnAck({kSession, 0, 1, {}, 0, false, 1});
  EXPECT_FALSE(downlink_.Await(std::chrono::steady_clock::now())) << "not yet, but the time is over";
  std::thread server([this] { downlink_.OnAck({kSession, 0, 1, {}, 0, false, 2}); });
  EXPECT_FALSE(downlink_.Await(Downlink::Time::max()));
  server.join();
  downlink_.OnClaim(3);
  downlink_.OnServerLost();
  EXPECT_FALSE(downlink_.Await(Downlink::Time::max())) << "nobody is left to agree";
  EXPECT_TRUE(downlink_.agrees());
  downlink_.OnClaim(4);
  EXPECT_FALSE(downlink_.agrees());
  downlink_.OnClaim(0);
  EXPECT_FALSE(downlink_.Await(Downlink::Time::max())) << "it is not asked any more";
}

TEST_F(DownlinkTest, ACorrectionIsCompleteOnlyWhereNothingWasSentSince) {
  AgentCorrection correction = Correction(5, 0);
  correction.complete = true;
  Receive(correction);
  downlink_.Offer(stream_);
  auto ready = downlink_.Take();
  ASSERT_TRUE(ready);
  EXPECT_TRUE(ready->correction->complete);
  stream_.Absorb(*ready->correction);
  downlink_.OnAbsorbed(stream_.version());
  SendOne();
  correction.version = 6;
  Receive(correction);
  downlink_.Offer(stream_);
  ready = downlink_.Take();
  ASSERT_TRUE(ready);
  EXPECT_FALSE(ready->correction->complete);
}

TEST_F(DownlinkTest, WaitingEndsWhenTheServerGoesOrTheTimeIsOverOrSomebodyHurries) {
  downlink_.OnAck({kSession, 0, 1, {}, 5, true});
  EXPECT_FALSE(downlink_.Await(std::chrono::steady_clock::now()));
  downlink_.OnServerLost();
  EXPECT_FALSE(downlink_.Await(Downlink::Time::max()));
  downlink_.OnAck({kSession, 0, 1, {}, 5, true});
  downlink_.EndWaiting();
  EXPECT_FALSE(downlink_.Await(Downlink::Time::max()));
}

}  // namespace
}  // namespace pangaea
