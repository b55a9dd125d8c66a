#include "agent/absorption/absorption.h"

#include <gtest/gtest.h>

#include <deque>
#include <random>

#include "agent/uplink/digest_grid.h"
#include "agent/uplink/edit_stream.h"
#include "agent/uplink/kept_keyframes.h"
#include "common/map/consistency.h"
#include "common/map/digest.h"
#include "common/map/forgetting.h"
#include "tests/agent/absorption_model_server.h"
#include "tests/agent/uplink_random_history.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

using Time = EditStream::Time;
constexpr SessionId kSession = RandomHistory::kSession;

std::shared_ptr<const Atlas> SnapshotOf(const Atlas& atlas) { return std::make_shared<const Atlas>(atlas); }

// An agent with its uplink, and a server that corrects it.
class Correspondence {
 public:
  explicit Correspondence(std::uint64_t seed, bool forgets = false)
      : random_(seed),
        forgets_(forgets),
        agent(seed, true),
        server(kSession, seed + 1000),
        stream(kSession, Options(), nullptr) {
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
  void Plan(PlanKind kind = PlanKind::kOngoing, std::vector<ForgottenKeyframe> forgetting = {}) {
    const std::vector<MapEdit> edits = agent.Take();
    const auto snapshot = SnapshotOf(agent.atlas());
    ASSERT_TRUE(stream.Take(snapshot, edits, kind, std::move(forgetting)));
    if (!forgets_) return;
    // The server may know an older one.
    if (random_() % 2 == 0) interest = InterestOf(kSession, *snapshot, stream.confirmed(), agent.newest(), Kept());
  }
  // As mapping and uplink do it: what was chosen some time ago, named with the edits since.
  void ForgetSome() {
    const auto chosen = std::exchange(
        forgettable_, ChooseForgotten(agent.atlas(), stream.confirmed(), agent.newest(), kSession, Kept()));
    std::vector<KeyframeId> present;
    for (const KeyframeId id : chosen) {
      const Keyframe* keyframe = agent.atlas().FindKeyframe(id);
      if (keyframe != nullptr && !IsForgotten(*keyframe)) present.push_back(id);
    }
    if (present.empty()) return;
    forgotten += static_cast<int>(present.size());
    Plan(PlanKind::kOngoing, agent.Forget(present));
    ASSERT_EQ(CheckConsistency(agent.atlas()), std::vector<std::string>{});
  }
  // The oldest correction under way, once its time has come.
  void AbsorbOne() {
    if (on_the_way.empty()) return;
    const AgentCorrection& correction = on_the_way.front();
    const auto base = stream.BaseOf(correction);
    if (!base) return;
    const AbsorptionInput input{kSession, correction.version, *base, correction.pieces, correction.complete};
    for (const MapEdit& edit : PlanAbsorption(agent.atlas(), input).edits) {
      const auto* added = std::get_if<AddKeyframe>(&edit);
      recalled += added != nullptr && agent.atlas().FindKeyframe(added->id) != nullptr ? 1 : 0;
      agent.Do(edit);
    }
    stream.Absorb(correction);
    on_the_way.pop_front();
    Plan();
    ASSERT_TRUE(CheckConsistency(agent.atlas()).empty());
  }
  void Step() {
    const int choice = static_cast<int>(random_() % 100);
    if (forgets_ && choice < 8) return ForgetSome();
    if (choice < 60) return agent.Step();
    if (choice < 70) return Plan();
    if (choice < 80) return Send(static_cast<int>(random_() % 4));
    if (choice < 87) return Acknowledge();
    if (choice < 93) return server.Work();
    if (choice < 96) return on_the_way.push_back(server.Tell(interest));
    AbsorbOne();
  }
  // So many steps, a last correction, and then until nothing is under way in either direction.
  void Run(int steps) {
    for (int step = 0; step < steps; ++step) {
      Step();
      if (testing::Test::HasFatalFailure()) return;
    }
    on_the_way.push_back(server.Tell(interest));
    Settle();
  }
  // Until nothing is under way in either direction.
  void Settle() {
    for (int round = 0; round < 20; ++round) {
      Plan(PlanKind::kFlush);
      Send(10000);
      Acknowledge();
      if (testing::Test::HasFatalFailure()) return;
      // What of the last envelopes was in vain.
      if (round < 3) on_the_way.push_back(server.Tell(interest));
      while (!on_the_way.empty()) {
        const std::size_t before = on_the_way.size();
        AbsorbOne();
        ASSERT_LT(on_the_way.size(), before) << "a correction is never absorbed";
      }
    }
    for (const MapEdit& edit : stream.own_edits()) agent.Do(edit);
  }
  // Asks whether both have the same; where they have not, has it told anew, and asks again. True where they have.
  bool Agree() {
    for (std::uint64_t number = 1; number <= 10; ++number) {
      MapInterest claiming = InterestOf(kSession, agent.atlas(), stream.confirmed(), agent.newest(), Kept());
      claiming.applied_version = stream.version();
      claiming.claim = {number, stream.retained().last_sequence(), DigestOfSession(agent.atlas(), kSession)};
      auto correction = server.Judge(claiming);
      if (!correction) return true;
      complete += correction->complete ? 1 : 0;  // else it brings what is wanted back
      on_the_way.push_back(std::move(*correction));
      AbsorbOne();
      Plan(PlanKind::kFlush);
      for (int round = 0; round < 5 && !stream.finished(); ++round) {
        Send(10000);
        Acknowledge();
      }
      if (testing::Test::HasFatalFailure()) return false;
      for (const MapEdit& edit : stream.own_edits()) agent.Do(edit);
    }
    return false;
  }

 private:
  static EditStreamOptions Options() {
    EditStreamOptions options;
    options.envelope_bytes = 1000;
    return options;
  }
  // So few that everything is forgotten now and then.
  static KeptKeyframesOptions Kept() { return {.most = 5, .left = 3, .recalled = 8, .newest = 1, .window = 1}; }
  std::mt19937_64 random_;
  bool forgets_;
  std::vector<KeyframeId> forgettable_;

 public:
  RandomHistory agent;
  CorrectingServer server;
  EditStream stream;
  std::deque<AgentCorrection> on_the_way;
  MapInterest interest;
  int forgotten = 0;
  int recalled = 0;
  int complete = 0;  // corrections that were
};

// What of what the agent holds of its session is other at the server.
std::vector<std::string> Differences(const Atlas& agent, const Atlas& server) {
  std::vector<std::string> differences;
  agent.ForEachKeyframe(kSession, [&](const Keyframe& here) {
    const Keyframe* there = server.FindKeyframe(here.id);
    if (there == nullptr || !OnSameGrid(here.camera_from_map, there->camera_from_map)) {
      differences.push_back("keyframe " + ToString(here.id) + (there == nullptr ? " is gone" : " is elsewhere"));
    }
    for (std::size_t i = 0; there != nullptr && i < here.landmarks.size(); ++i) {
      if (here.landmarks[i] == there->landmarks[i]) continue;
      differences.push_back("keypoint " + std::to_string(i) + " of " + ToString(here.id) + " shows " +
                            ToString(here.landmarks[i]) + ", there " + ToString(there->landmarks[i]));
    }
  });
  server.ForEachKeyframe(kSession, [&](const Keyframe& there) {
    if (agent.FindKeyframe(there.id) == nullptr)
      differences.push_back("keyframe " + ToString(there.id) + " is not here");
  });
  agent.ForEachLandmark(kSession, [&](const Landmark& here) {
    const Landmark* there = server.FindLandmark(here.id);
    if (there != nullptr && OnSameGrid(here.point_in_map, there->point_in_map)) return;
    differences.push_back("landmark " + ToString(here.id) + (there == nullptr ? " is gone" : " is elsewhere") +
                          ", reference " + ToString(here.reference) +
                          (there == nullptr ? "" : ", there " + ToString(there->reference)));
  });
  return differences;
}

class AbsorptionHistory : public testing::TestWithParam<std::uint64_t> {};

// The server takes a sighting away from a landmark, and then makes it one with another that the same keyframe sees.
TEST(Absorption, AKeypointThatALandmarkGetsByFusionInPlaceOfALostOneIsItsOwn) {
  SmallWorld world = RowOfThree();
  world.Add(L(7), K(2), 7);
  world.Observe(L(7), K(3), 7);
  const Atlas agent = world.atlas;
  world.Do(RemoveObservation{L(1), K(2)});
  world.Do(FuseLandmarks{L(1), L(7)});
  ASSERT_EQ(world.Get(K(2)).landmarks[7], L(1));
  PieceSelection selection;
  selection.map = M(1);
  selection.keyframes = {K(1), K(2), K(3)};
  selection.held = {K(1), K(2), K(3)};
  selection.landmarks = {L(1)};
  selection.former_landmarks = {L(7)};
  const std::vector<MapPiece> pieces = {CutPiece(world.atlas, selection)};
  const Absorption absorption = PlanAbsorption(agent, {kAnna, 1, agent, pieces});
  EXPECT_EQ(absorption.after.FindLandmark(L(1))->observations, world.Get(L(1)).observations);
  EXPECT_EQ(DigestOfSession(absorption.after, kAnna), DigestOfSession(world.atlas, kAnna));
}

// Of two landmarks that two agents find to be one, each keeps the other's. The server takes the first word it gets.
TEST(Absorption, OfTwoFusionsThatCrossTheServersHolds) {
  SmallWorld world = RowOfThree();
  world.Child(K(1, kBert), K(3), M(1));
  world.Add(L(1, kBert), K(1, kBert), 1);
  world.Observe(L(1, kBert), K(3), 7);
  const Atlas before = world.atlas;
  SmallWorld agent = world;
  agent.Do(FuseLandmarks{L(1, kBert), L(1)});
  world.Do(FuseLandmarks{L(1), L(1, kBert)});
  ASSERT_EQ(world.Get(K(3)).landmarks[7], L(1));
  PieceSelection selection;
  selection.map = M(1);
  selection.keyframes = {K(1), K(2), K(3)};
  selection.held = {K(1), K(2), K(3)};
  selection.landmarks = {L(1)};
  selection.former_landmarks = {L(1, kBert)};
  const std::vector<MapPiece> pieces = {CutPiece(world.atlas, selection)};
  for (const Atlas* told : {&before, &std::as_const(agent.atlas)}) {
    const Absorption absorption = PlanAbsorption(agent.atlas, {kAnna, 1, *told, pieces});
    EXPECT_EQ(DigestOfSession(absorption.after, kAnna), DigestOfSession(world.atlas, kAnna));
    EXPECT_EQ(CheckConsistency(absorption.after), std::vector<std::string>{});
  }
}

TEST_P(AbsorptionHistory, WhateverTheServerCorrectsAndWheneverItArrivesBothEndWithTheSame) {
  Correspondence pair(GetParam());
  pair.Run(1500);
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_FALSE(pair.stream.gave_up());
  EXPECT_EQ(pair.stream.repairs(), 0U);
  EXPECT_TRUE(CheckConsistency(pair.agent.atlas()).empty());
  EXPECT_TRUE(CheckConsistency(pair.server.atlas).empty());
  EXPECT_EQ(DigestOfSession(pair.agent.atlas(), kSession), DigestOfSession(pair.server.atlas, kSession))
      << testing::PrintToString(Differences(pair.agent.atlas(), pair.server.atlas));
  EXPECT_GT(pair.server.atlas.keyframe_count(kSession), 0U);
}

TEST_P(AbsorptionHistory, WhateverTheAgentForgetsAndWhateverComesBackBothEndWithTheSame) {
  Correspondence pair(GetParam(), true);
  pair.Run(2500);
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_FALSE(pair.stream.gave_up());
  EXPECT_EQ(pair.stream.repairs(), 0U);
  EXPECT_EQ(CheckConsistency(pair.agent.atlas()), std::vector<std::string>{});
  std::set<KeyframeId> forgotten;
  pair.agent.atlas().ForEachKeyframe(kSession, [&](const Keyframe& keyframe) {
    if (IsForgotten(keyframe)) forgotten.insert(keyframe.id);
  });
  EXPECT_EQ(DigestOfSession(pair.agent.atlas(), kSession), DigestOfSession(pair.server.atlas, kSession, forgotten))
      << testing::PrintToString(Differences(pair.agent.atlas(), pair.server.atlas));
  EXPECT_GT(pair.forgotten, 0);
  EXPECT_GT(pair.recalled, 0);
}

// As if there were an error in what corrections tell.
TEST_P(AbsorptionHistory, WhateverTheServerKeptToItselfAfterAClaimBothHoldTheSame) {
  const bool forgets = GetParam() % 2 == 0;
  Correspondence pair(GetParam(), forgets);
  pair.Run(800);
  ASSERT_FALSE(HasFatalFailure());
  for (int i = 0; i < 30; ++i) pair.server.Work();
  pair.server.ForgetWhatChanged();
  EXPECT_TRUE(pair.Agree()) << testing::PrintToString(Differences(pair.agent.atlas(), pair.server.atlas));
  // What a forgetting agent asks back may have brought all of it.
  if (!forgets) {
    EXPECT_GE(pair.complete, 1);
  }
  EXPECT_EQ(CheckConsistency(pair.agent.atlas()), std::vector<std::string>{});
  EXPECT_EQ(Differences(pair.agent.atlas(), pair.server.atlas), std::vector<std::string>{});
  EXPECT_EQ(CheckConsistency(pair.server.atlas), std::vector<std::string>{});
  EXPECT_EQ(pair.stream.repairs(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Seeds, AbsorptionHistory, testing::Range<std::uint64_t>(1, 31));

}  // namespace
}  // namespace pangaea
