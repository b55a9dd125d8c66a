#include "agent/runtime/uplink_thread.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>

#include "agent/runtime/mapping_worker.h"
#include "agent/runtime/spill_file.h"
#include "common/base/bounded_queue.h"
#include "common/dds/reader.h"
#include "common/dds/waiter.h"
#include "common/dds/writer.h"
#include "common/map/digest.h"
#include "common/map/map_edit.h"
#include "tests/agent/uplink_random_history.h"
#include "tests/dds/two_processes.h"

namespace pangaea {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

std::filesystem::path SpillPath() {
  return std::filesystem::temp_directory_path() / ("pangaea-test-" + std::to_string(getpid()) + ".spill");
}

UplinkOptions Options() {
  UplinkOptions options;
  options.spill_path = SpillPath();
  options.edits.envelope_bytes = 2000;
  options.edits.retained.first_timeout = 100ms;
  return options;
}

SessionAnnouncement Session() {
  SessionAnnouncement session;
  session.session = RandomHistory::kSession;
  session.name = "a1";
  session.ideal_camera = {640, 480, 400.0, 400.0, 320.0, 240.0, 0.1};
  return session;
}

// What a server keeps across its deaths.
struct Durable {
  Atlas atlas;
  std::uint64_t up_to = 0;
  std::uint64_t incarnations = 0;
  std::function<bool(std::uint64_t)> rejects = [](std::uint64_t) { return false; };  // by sequence
};

// One run of a server: applies what comes in order, and acks. Its callbacks are its only thread.
class ModelServer {
 public:
  ModelServer(const Participant& participant, Durable& durable)
      : durable_(durable),
        incarnation_(++durable.incarnations),
        edits_(Reader<Envelope>::Open(participant).value()),
        sessions_(Reader<SessionAnnouncement>::Open(participant).value()),
        acks_(Writer<EditAck>::Open(participant).value()),
        waiter_(Waiter::Create(participant).value()) {
    EXPECT_TRUE(waiter_->OnSample<Envelope>(edits_, [this](Sample<Envelope> sample) {
      if (sample.alive) Take(sample.value);
    }));
    EXPECT_TRUE(waiter_->OnSample<SessionAnnouncement>(
        sessions_, [this](Sample<SessionAnnouncement> sample) { announcements.PushNewest(std::move(sample)); }));
    waiter_->Start();
  }

  // Call before looking at what it keeps.
  void Stop() { waiter_->Stop(); }

  BoundedQueue<Sample<SessionAnnouncement>> announcements{10};
  BoundedQueue<std::uint64_t> taken{100000};

 private:
  void Take(const Envelope& envelope) {
    ASSERT_TRUE(CheckEnvelope(envelope));
    std::vector<Rejection> rejections;
    if (envelope.sequence == durable_.up_to + 1) {
      const auto edits = DecodeEdits(envelope.edits);
      ASSERT_TRUE(edits);
      if (!TakeWhole(*edits)) rejections.push_back({envelope.sequence, RejectionReason::kInvalid, "no such luck"});
      durable_.up_to = envelope.sequence;
      taken.PushNewest(envelope.sequence);
    }
    EXPECT_TRUE(acks_.Write({envelope.session, durable_.up_to, incarnation_, std::move(rejections)}));
  }
  bool TakeWhole(const std::vector<MapEdit>& edits) {
    if (durable_.rejects(durable_.up_to + 1)) return false;
    Atlas changed = durable_.atlas;
    for (const MapEdit& edit : edits) {
      if (!Apply(edit, changed)) return false;
    }
    durable_.atlas = std::move(changed);
    return true;
  }

  Durable& durable_;
  std::uint64_t incarnation_;
  Reader<Envelope> edits_;
  Reader<SessionAnnouncement> sessions_;
  Writer<EditAck> acks_;
  std::unique_ptr<Waiter> waiter_;
};

// An agent whose mapping is a random history.
struct Agent {
  explicit Agent(std::uint64_t seed, UplinkOptions options = Options())
      : node(1), history(seed), uplink(UplinkThread::Start(node.participant, Session(), options).value()) {}

  UplinkBatch Work(int steps) {
    for (int i = 0; i < steps; ++i) history.Step();
    return {std::make_shared<const Atlas>(history.atlas()), history.Take()};
  }
  // The agent's atlas once it adopted what the flush asked it to.
  Atlas Adopted(const std::vector<MapEdit>& own_edits) const {
    Atlas atlas = history.atlas();
    for (const MapEdit& edit : own_edits) EXPECT_TRUE(Apply(edit, atlas));
    return atlas;
  }

  TestNode node;
  RandomHistory history;
  std::unique_ptr<UplinkThread> uplink;
};

TEST(UplinkThread, WhereTheCameraStandsItsKeyframesReachTheServerWithTime) {
  TestNode server_node(2);
  Durable durable;
  ModelServer server(server_node.participant, durable);
  TestNode node(1);
  const SessionAnnouncement session = Session();
  const auto uplink = UplinkThread::Start(node.participant, session, Options()).value();
  MappingWorker worker(session.session, KeyframeBuilder(session.ideal_camera, {}, {}), {}, uplink.get());
  const KeyframeId only{session.session, 1};
  auto data = std::make_shared<KeyframeData>();
  data->camera = session.ideal_camera;
  data->features.keypoints.resize(1);
  data->features.descriptors.resize(1);
  MappingInput first;
  first.root = std::make_shared<const KeyframeCandidate>(
      KeyframeCandidate{only, {session.session, 1}, data, {}, Rigid3d(), std::vector<LandmarkId>(1)});
  worker.Process(std::move(first));
  for (std::int64_t i = 1; i <= 140; ++i) {  // seven seconds: five until it is settled, and a batch of frames
    MappingInput input;
    input.frames.push_back({only, {.stamp_ns = i * 50'000'000, .reference_from_frame = Rigid3d()}});
    worker.Process(std::move(input));
  }
  EXPECT_TRUE(server.taken.PopUntil(std::chrono::steady_clock::now() + 10s)) << "nothing came";
  server.Stop();
  EXPECT_TRUE(durable.atlas.Knows(only));
}

TEST(UplinkThread, AfterAFlushBothDigestsAreEqual) {
  TestNode server_node(2);
  Durable durable;
  ModelServer server(server_node.participant, durable);
  Agent agent(1);
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(agent.uplink->Submit(agent.Work(20)));
  const auto own_edits = agent.uplink->Flush(agent.Work(20), 20s);
  ASSERT_TRUE(own_edits) << own_edits.error().message;
  server.Stop();
  EXPECT_EQ(Digest(durable.atlas), Digest(agent.Adopted(*own_edits)));
  const UplinkCounters counters = agent.uplink->counters();
  EXPECT_EQ(counters.acknowledged, counters.last_sequence);
  EXPECT_GT(counters.bytes_sent, 0U);
}

TEST(UplinkThread, TheSessionIsAnnouncedAndItsOrderlyEndToo) {
  TestNode server_node(2);
  Durable durable;
  ModelServer server(server_node.participant, durable);
  {
    Agent agent(1);
    const auto first = *server.announcements.Pop();
    EXPECT_EQ(first.value.name, "a1");
    EXPECT_EQ(first.value.site, "hall");
    EXPECT_FALSE(first.value.closed);
    agent.uplink->Stop();
    EXPECT_TRUE(server.announcements.Pop()->value.closed);
  }
  EXPECT_FALSE(server.announcements.Pop()->alive);
}

TEST(UplinkThread, EditsWaitForAServerThatComesLater) {
  Agent agent(2);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(agent.uplink->Submit(agent.Work(50)));
  TestNode server_node(2);
  Durable durable;
  ModelServer server(server_node.participant, durable);
  const auto own_edits = agent.uplink->Flush(agent.Work(20), 20s);
  ASSERT_TRUE(own_edits) << own_edits.error().message;
  server.Stop();
  EXPECT_EQ(Digest(durable.atlas), Digest(agent.Adopted(*own_edits)));
}

TEST(UplinkThread, AServerKilledAndRestartedGetsTheRestOnceAndInOrder) {
  Durable durable;
  Agent agent(3);
  for (int life = 0; life < 3; ++life) {
    TestNode server_node(2);
    ModelServer server(server_node.participant, durable);
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(agent.uplink->Submit(agent.Work(50)));
    server.taken.Pop();
  }
  TestNode server_node(2);
  ModelServer server(server_node.participant, durable);
  const auto own_edits = agent.uplink->Flush(agent.Work(20), 20s);
  ASSERT_TRUE(own_edits) << own_edits.error().message;
  server.Stop();
  EXPECT_EQ(Digest(durable.atlas), Digest(agent.Adopted(*own_edits)));
  EXPECT_EQ(durable.up_to, agent.uplink->counters().last_sequence);
}

TEST(UplinkThread, ALinkThatWasCutLosesNothing) {
  TestNode server_node(2);
  Durable durable;
  ModelServer server(server_node.participant, durable);
  Agent agent(4);
  ASSERT_TRUE(agent.uplink->Submit(agent.Work(500)));
  server.taken.Pop();
  server_node.domain.SetLinkDown(true);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(agent.uplink->Submit(agent.Work(50)));
  EXPECT_FALSE(agent.uplink->Flush(agent.Work(1), 200ms));
  server_node.domain.SetLinkDown(false);
  const auto own_edits = agent.uplink->Flush(agent.Work(20), 30s);
  ASSERT_TRUE(own_edits) << own_edits.error().message;
  server.Stop();
  EXPECT_EQ(Digest(durable.atlas), Digest(agent.Adopted(*own_edits)));
}

TEST(UplinkThread, WhatTheServerRejectsIsSentAnew) {
  TestNode server_node(2);
  Durable durable;
  durable.rejects = [](std::uint64_t sequence) { return sequence % 7 == 2; };
  ModelServer server(server_node.participant, durable);
  Agent agent(7);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(agent.uplink->Submit(agent.Work(50)));
  const auto own_edits = agent.uplink->Flush(agent.Work(20), 20s);
  ASSERT_TRUE(own_edits) << own_edits.error().message;
  server.Stop();
  EXPECT_EQ(Digest(durable.atlas), Digest(agent.Adopted(*own_edits)));
  EXPECT_GT(agent.uplink->counters().rejections, 0U);
  EXPECT_GT(agent.uplink->counters().repairs, 0U);
}

TEST(UplinkThread, AServerThatRejectsEverythingIsTold) {
  TestNode server_node(2);
  Durable durable;
  durable.rejects = [](std::uint64_t) { return true; };
  ModelServer server(server_node.participant, durable);
  Agent agent(8);
  const auto flushed = agent.uplink->Flush(agent.Work(100), 20s);
  ASSERT_FALSE(flushed);
  EXPECT_EQ(flushed.error().code, ErrorCode::kRefused);
  EXPECT_NE(flushed.error().message.find("no such luck"), std::string::npos) << flushed.error().message;
  EXPECT_EQ(agent.uplink->counters().repairs, 3U);
}

TEST(UplinkThread, WithoutAServerAFlushFailsInTimeAndLeavesEverythingInTheSpillFile) {
  std::uint64_t last = 0;
  {
    UplinkOptions options = Options();
    options.edits.retained.memory_bytes = 10'000;
    Agent agent(5, options);
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(agent.uplink->Submit(agent.Work(50)));
    const auto flushed = agent.uplink->Flush(agent.Work(1), 50ms);
    ASSERT_FALSE(flushed);
    EXPECT_EQ(flushed.error().code, ErrorCode::kUnavailable);
    EXPECT_NE(flushed.error().message.find(SpillPath().string()), std::string::npos);
    last = agent.uplink->counters().last_sequence;
  }
  EXPECT_GT(last, 5U);
  EXPECT_GT(std::filesystem::file_size(SpillPath()), 10'000U);
  std::filesystem::remove(SpillPath());
}

TEST(UplinkThread, AfterStopNothingIsTaken) {
  Agent agent(6);
  agent.uplink->Stop();
  agent.uplink->Stop();
  EXPECT_FALSE(agent.uplink->Submit(agent.Work(10)));
  EXPECT_FALSE(agent.uplink->Flush(agent.Work(10), 1s));
}

TEST(SpillFile, GivesBackWhatWasAppendedAndVanishesWhenEmpty) {
  {
    SpillFile file(SpillPath());
    for (std::uint64_t i = 1; i <= 5; ++i) ASSERT_TRUE(file.Append(MakeEnvelope(3, i, 0, {})));
    EXPECT_EQ(file.Read(4).value(), MakeEnvelope(3, 4, 0, {}));
    file.Discard(4);
    EXPECT_FALSE(file.Read(4));
    EXPECT_TRUE(file.Read(5));
    file.Discard(5);
  }
  EXPECT_FALSE(std::filesystem::exists(SpillPath()));
}

TEST(SpillFile, APathThatCannotBeWrittenIsAnError) {
  SpillFile file("/nonexistent-folder/file.spill");
  const Status status = file.Append(MakeEnvelope(3, 1, 0, {}));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kUnavailable);
}

TEST(SpillFile, ADamagedEnvelopeIsToldAsSuch) {
  SpillFile file(SpillPath());
  const std::vector<MapEdit> edits = {CloseMap{{3, 1}}};
  ASSERT_TRUE(file.Append(MakeEnvelope(3, 1, 0, edits)));
  {
    std::fstream other(SpillPath(), std::ios::in | std::ios::out | std::ios::binary);
    other.seekp(-1, std::ios::end);
    other.put('x');
  }
  const auto envelope = file.Read(1);
  ASSERT_FALSE(envelope);
  EXPECT_EQ(envelope.error().code, ErrorCode::kCorrupt);
  file.Discard(1);
}

}  // namespace
}  // namespace pangaea
