#include "agent/absorption/absorption.h"

#include <gtest/gtest.h>

#include <deque>
#include <random>

#include "agent/uplink/edit_stream.h"
#include "common/map/consistency.h"
#include "common/map/digest.h"
#include "tests/agent/absorption_model_server.h"
#include "tests/agent/uplink_random_history.h"

namespace pangaea {
namespace {

using Time = EditStream::Time;
constexpr SessionId kSession = RandomHistory::kSession;

std::shared_ptr<const Atlas> SnapshotOf(const Atlas& atlas) { return std::make_shared<const Atlas>(atlas); }

// An agent with its uplink, and a server that corrects it.
class Correspondence {
 public:
  explicit Correspondence(std::uint64_t seed)
      : random_(seed), agent(seed, true), server(kSession, seed + 1000), stream(kSession, Options(), nullptr) {
    stream.retained().OnServerPresent(true);
  }

  void Send(int most) {
    for (int i = 0; i < most; ++i) {
      const auto envelope = stream.retained().NextToSend();
      ASSERT_TRUE(envelope);
      if (!*envelope) break;
      server.Take(**envelope);
      if (testing::Test::HasFatalFailure()) return;
      stream.retained().OnSent((*envelope)->sequence, Time());
    }
  }
  void Acknowledge() {
    stream.OnAck(server.Ack(), Time());
    ASSERT_TRUE(stream.Continue());
  }
  void Plan(PlanKind kind = PlanKind::kOngoing) {
    const std::vector<MapEdit> edits = agent.Take();
    ASSERT_TRUE(stream.Take(SnapshotOf(agent.atlas()), edits, kind));
  }
  // The oldest correction under way, once its time has come.
  void AbsorbOne() {
    if (on_the_way.empty()) return;
    const AgentCorrection& correction = on_the_way.front();
    const auto base = stream.BaseOf(correction);
    if (!base) return;
    const AbsorptionInput input{kSession, correction.version, *base, correction.pieces};
    for (const MapEdit& edit : PlanAbsorption(agent.atlas(), input)) agent.Do(edit);
    stream.Absorb(correction);
    on_the_way.pop_front();
    Plan();
    ASSERT_TRUE(CheckConsistency(agent.atlas()).empty());
  }
  void Step() {
    const int choice = static_cast<int>(random_() % 100);
    if (choice < 60) return agent.Step();
    if (choice < 70) return Plan();
    if (choice < 80) return Send(static_cast<int>(random_() % 4));
    if (choice < 87) return Acknowledge();
    if (choice < 93) return server.Work();
    if (choice < 96) return on_the_way.push_back(server.Tell());
    AbsorbOne();
  }
  // Until nothing is under way in either direction.
  void Settle() {
    for (int round = 0; round < 20; ++round) {
      Plan(PlanKind::kFlush);
      Send(10000);
      Acknowledge();
      if (testing::Test::HasFatalFailure()) return;
      while (!on_the_way.empty()) {
        const std::size_t before = on_the_way.size();
        AbsorbOne();
        ASSERT_LT(on_the_way.size(), before) << "a correction is never absorbed";
      }
    }
    for (const MapEdit& edit : stream.own_edits()) agent.Do(edit);
  }

 private:
  static EditStreamOptions Options() {
    EditStreamOptions options;
    options.envelope_bytes = 1000;
    return options;
  }
  std::mt19937_64 random_;

 public:
  RandomHistory agent;
  CorrectingServer server;
  EditStream stream;
  std::deque<AgentCorrection> on_the_way;
};

class AbsorptionHistory : public testing::TestWithParam<std::uint64_t> {};

TEST_P(AbsorptionHistory, WhateverTheServerCorrectsAndWheneverItArrivesBothEndWithTheSame) {
  Correspondence pair(GetParam());
  for (int step = 0; step < 1500; ++step) {
    pair.Step();
    ASSERT_FALSE(HasFatalFailure());
  }
  pair.on_the_way.push_back(pair.server.Tell());
  pair.Settle();
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_FALSE(pair.stream.gave_up());
  EXPECT_EQ(pair.stream.repairs(), 0U);
  EXPECT_TRUE(CheckConsistency(pair.agent.atlas()).empty());
  EXPECT_TRUE(CheckConsistency(pair.server.atlas).empty());
  EXPECT_EQ(DigestOfSession(pair.agent.atlas(), kSession), DigestOfSession(pair.server.atlas, kSession));
  EXPECT_GT(pair.server.atlas.keyframe_count(kSession), 0U);
}

INSTANTIATE_TEST_SUITE_P(Seeds, AbsorptionHistory, testing::Range<std::uint64_t>(1, 31));

}  // namespace
}  // namespace pangaea
