#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <set>

#include "agent/uplink/edit_stream.h"
#include "common/map/consistency.h"
#include "common/map/digest.h"
#include "common/map/map_edit.h"
#include "tests/agent/spill_map.h"
#include "tests/agent/uplink_random_history.h"

namespace pangaea {
namespace {

using Time = EditStream::Time;

EditStreamOptions Options() {
  EditStreamOptions options;
  options.envelope_bytes = 1000;  // many envelopes
  return options;
}

// A server that takes an envelope whole or rejects it whole, and rejects some for no reason that the agent could know.
class ModelServer {
 public:
  using Whim = std::function<bool(const std::vector<MapEdit>&)>;
  explicit ModelServer(Whim rejects) : rejects_(std::move(rejects)) {}

  void Take(const Envelope& envelope) {
    if (envelope.sequence != up_to + 1) return;
    ++up_to;
    const auto edits = DecodeEdits(envelope.edits);
    ASSERT_TRUE(edits);
    Atlas changed = atlas;
    bool fits = !rejects_(*edits);
    for (std::size_t i = 0; fits && i < edits->size(); ++i) fits = Apply((*edits)[i], changed).has_value();
    if (fits) {
      atlas = std::move(changed);
    } else {
      rejections_.push_back({up_to, RejectionReason::kUnspecified, "no"});
    }
  }
  EditAck Ack() { return {RandomHistory::kSession, up_to, 1, std::exchange(rejections_, {})}; }

  Atlas atlas;
  std::uint64_t up_to = 0;

 private:
  Whim rejects_;
  std::vector<Rejection> rejections_;
};

// Sends up to `most` envelopes and hears the answer; repairs where that is due.
void Exchange(EditStream& stream, ModelServer& server, int most) {
  stream.retained().OnServerPresent(true);
  for (int i = 0; i < most; ++i) {
    const auto envelope = stream.retained().NextToSend();
    ASSERT_TRUE(envelope);
    if (!*envelope) break;
    server.Take(**envelope);
    stream.retained().OnSent((*envelope)->sequence, Time());
  }
  stream.OnAck(server.Ack(), Time());
  ASSERT_TRUE(stream.Continue());
}

void ExchangeAll(EditStream& stream, ModelServer& server) {
  for (int round = 0; !stream.finished(); ++round) {
    ASSERT_LT(round, 1000) << "it goes on for ever";
    Exchange(stream, server, 1000);
  }
}

std::shared_ptr<const Atlas> SnapshotOf(const Atlas& atlas) { return std::make_shared<const Atlas>(atlas); }

// An agent's random work, in batches; the server answers some of it in between.
void Work(RandomHistory& agent, EditStream& stream, ModelServer& server, std::mt19937_64& random) {
  for (int batch = 0; batch < 60; ++batch) {
    for (int step = 0; step < 20; ++step) agent.Step();
    ASSERT_TRUE(stream.Take(SnapshotOf(agent.atlas()), agent.Take(), PlanKind::kOngoing));
    Exchange(stream, server, static_cast<int>(random() % 12));
  }
}

// The agent's atlas once it adopted what the flush asked it to.
Atlas Adopted(const RandomHistory& agent, const EditStream& stream) {
  Atlas atlas = agent.atlas();
  for (const MapEdit& edit : stream.own_edits()) EXPECT_TRUE(Apply(edit, atlas));
  return atlas;
}

class EditStreamHistory : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(EditStreamHistory, WhateverTheServerRejectsAtRandomAfterAFlushTheDigestsAgree) {
  std::mt19937_64 random(GetParam());
  int rejected = 0;
  ModelServer server([&](const auto&) { return random() % 8 == 0 && ++rejected > 0; });
  RandomHistory agent(GetParam());
  EditStream stream(RandomHistory::kSession, Options(), nullptr);
  Work(agent, stream, server, random);
  ASSERT_TRUE(stream.Take(SnapshotOf(agent.atlas()), agent.Take(), PlanKind::kFlush));
  ExchangeAll(stream, server);
  EXPECT_GT(rejected, 0);
  EXPECT_GT(stream.repairs(), 0U);
  EXPECT_FALSE(stream.gave_up());
  EXPECT_EQ(Digest(server.atlas), Digest(Adopted(agent, stream)));
  EXPECT_EQ(CheckConsistency(server.atlas), std::vector<std::string>());
  for (const MapId map : agent.atlas().Maps()) {
    EXPECT_EQ(server.atlas.FindMap(map)->closed, agent.atlas().FindMap(map)->closed);
  }
}

TEST_P(EditStreamHistory, WhatTheServerRefusesForGoodIsGivenUpAndTheRestArrives) {
  std::mt19937_64 random(GetParam());
  RandomHistory agent(GetParam());
  for (int step = 0; step < 200; ++step) agent.Step();
  LandmarkId refused;
  agent.atlas().ForEachLandmark([&](const Landmark& landmark) { refused = landmark.id; });
  ASSERT_TRUE(refused.valid());
  ModelServer server([&](const std::vector<MapEdit>& edits) {
    return std::any_of(edits.begin(), edits.end(), [&](const MapEdit& edit) {
      const auto* added = std::get_if<AddLandmark>(&edit);
      return added != nullptr && added->id == refused;
    });
  });
  EditStream stream(RandomHistory::kSession, Options(), nullptr);
  ASSERT_TRUE(stream.Take(SnapshotOf(agent.atlas()), agent.Take(), PlanKind::kFlush));
  ExchangeAll(stream, server);
  ASSERT_TRUE(stream.gave_up());
  Atlas without = Adopted(agent, stream);
  ASSERT_TRUE(Apply(MapEdit(RemoveLandmark{refused}), without));
  EXPECT_EQ(server.atlas.keyframe_count(), without.keyframe_count());
  EXPECT_EQ(server.atlas.landmark_count(), without.landmark_count());
  EXPECT_LT(stream.repairs(), 10U);
}

INSTANTIATE_TEST_SUITE_P(Seeds, EditStreamHistory, ::testing::Range<std::uint64_t>(1, 31));

TEST(EditStream, WithoutRejectionsNothingIsRepaired) {
  std::mt19937_64 random(1);
  ModelServer server([](const auto&) { return false; });
  RandomHistory agent(1);
  EditStream stream(RandomHistory::kSession, Options(), nullptr);
  Work(agent, stream, server, random);
  ASSERT_TRUE(stream.Take(SnapshotOf(agent.atlas()), agent.Take(), PlanKind::kFlush));
  ExchangeAll(stream, server);
  EXPECT_EQ(stream.repairs(), 0U);
  EXPECT_EQ(Digest(server.atlas), Digest(Adopted(agent, stream)));
}

TEST(EditStream, AServerThatRejectsEverythingIsAskedAFewTimes) {
  ModelServer server([](const auto&) { return true; });
  RandomHistory agent(2);
  for (int step = 0; step < 200; ++step) agent.Step();
  EditStream stream(RandomHistory::kSession, Options(), nullptr);
  ASSERT_TRUE(stream.Take(SnapshotOf(agent.atlas()), agent.Take(), PlanKind::kFlush));
  ExchangeAll(stream, server);
  EXPECT_TRUE(stream.gave_up());
  EXPECT_EQ(stream.repairs(), 3U);
}

TEST(EditStream, WhileARepairIsDueNoNewEnvelopesAreMadeAndTheRepairHasWhatCameMeanwhile) {
  int left = 1;
  ModelServer server([&](const auto&) { return left-- > 0; });
  RandomHistory agent(3);
  for (int step = 0; step < 300; ++step) agent.Step();
  EditStream stream(RandomHistory::kSession, Options(), nullptr);
  ASSERT_TRUE(stream.Take(SnapshotOf(agent.atlas()), agent.Take(), PlanKind::kOngoing));
  const std::uint64_t planned = stream.retained().last_sequence();
  ASSERT_GT(planned, 1U);
  Exchange(stream, server, 1);  // the first, rejected
  for (int step = 0; step < 300; ++step) agent.Step();
  ASSERT_TRUE(stream.Take(SnapshotOf(agent.atlas()), agent.Take(), PlanKind::kFlush));
  EXPECT_EQ(stream.retained().last_sequence(), planned);
  EXPECT_FALSE(stream.finished());
  ExchangeAll(stream, server);
  EXPECT_EQ(stream.repairs(), 1U);
  EXPECT_EQ(Digest(server.atlas), Digest(Adopted(agent, stream)));
}

TEST(EditStream, ARepairBeforeTheEndPutsWhatIsMissingBehindWhatIsNotAnswered) {
  int left = 1;
  ModelServer server([&](const auto&) { return left-- > 0; });
  RandomHistory agent(4);
  for (int step = 0; step < 600; ++step) agent.Step();
  testing::SpillMap spill;
  EditStream stream(RandomHistory::kSession, Options(), &spill);
  ASSERT_TRUE(stream.Take(SnapshotOf(agent.atlas()), agent.Take(), PlanKind::kFlush));
  Exchange(stream, server, 1);  // the first, rejected
  ASSERT_FALSE(stream.retained().all_acknowledged());
  ASSERT_TRUE(stream.PlanRest());
  ASSERT_TRUE(stream.retained().SpillAll());
  EXPECT_EQ(stream.retained().memory_bytes(), 0U);
  // Who reads the spill file later sends all of it, in order.
  for (const auto& [sequence, envelope] : spill.envelopes) server.Take(envelope);
  EXPECT_EQ(Digest(server.atlas), Digest(Adopted(agent, stream)));
}

TEST(EditStream, ARejectionThatComesTooLateIsNotTakenForSuccess) {
  ModelServer server([](const auto&) { return false; });
  RandomHistory agent(5);
  for (int step = 0; step < 200; ++step) agent.Step();
  EditStream stream(RandomHistory::kSession, Options(), nullptr);
  ASSERT_TRUE(stream.Take(SnapshotOf(agent.atlas()), agent.Take(), PlanKind::kFlush));
  ExchangeAll(stream, server);
  EXPECT_FALSE(stream.gave_up());
  stream.OnAck({RandomHistory::kSession, server.up_to, 1, {{1, RejectionReason::kInvalid, "no"}}}, Time());
  EXPECT_TRUE(stream.gave_up());
}

}  // namespace
}  // namespace pangaea
