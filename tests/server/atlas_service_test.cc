#include "server/runtime/atlas_service.h"

#include <gtest/gtest.h>

#include <thread>

#include "common/map/digest.h"
#include "tests/map/small_world.h"
#include "tests/server/service_harness.h"

namespace pangaea {
namespace {

// What the store holds at this moment, as a recovery would find it.
RecoveredAtlas Stored(const std::filesystem::path& path) {
  auto store = Store::OpenReadOnly(path);
  EXPECT_TRUE(store);
  auto recovered = RecoverAtlas(*store);
  EXPECT_TRUE(recovered) << recovered.error().message;
  return recovered ? *recovered : RecoveredAtlas();
}

TEST(AtlasService, WhatIsAcknowledgedIsInTheStoreAlready) {
  const TemporaryStore place;
  ServiceHarness harness(place.path());
  Flight flight(kAnna);
  for (std::uint64_t sequence = 1; sequence <= 20; ++sequence) {
    harness.Send(flight.Next());
    const EditAck ack = harness.WaitForAck(kAnna, sequence);
    EXPECT_EQ(ack.server_incarnation, 1u);
    EXPECT_EQ(Digest(Stored(place.path()).atlas), Digest(flight.atlas()));
  }
}

TEST(AtlasService, ManySessionsAtOnceEndInTheAtlasTheySent) {
  const TemporaryStore place;
  ServiceHarness harness(place.path(), {.snapshot_envelopes = 25});
  std::vector<Flight> flights;
  for (SessionId session = 1; session <= 4; ++session) flights.emplace_back(session);
  constexpr std::uint64_t kEnvelopes = 50;
  std::vector<std::thread> agents;
  for (Flight& flight : flights) {
    agents.emplace_back([&harness, &flight] {
      for (std::uint64_t i = 0; i < kEnvelopes; ++i) harness.Send(flight.Next());
      harness.WaitForAck(flight.session(), kEnvelopes);
    });
  }
  for (std::thread& agent : agents) agent.join();
  harness.service->Stop();
  const RecoveredAtlas stored = Stored(place.path());
  for (const Flight& flight : flights) {
    const std::uint64_t expected = DigestOfSession(flight.atlas(), flight.session());
    EXPECT_EQ(DigestOfSession(harness.service->State()->ingest.atlas, flight.session()), expected);
    EXPECT_EQ(DigestOfSession(stored.atlas, flight.session()), expected);
  }
  EXPECT_EQ(stored.position, kEnvelopes * flights.size()) << "each once";
}

TEST(AtlasService, ServerRestartedContinuesAfterTheLastAckUnderANewIncarnation) {
  const TemporaryStore place;
  Flight flight(kAnna);
  std::vector<Envelope> envelopes;
  for (int i = 0; i < 10; ++i) envelopes.push_back(flight.Next());
  {
    ServiceHarness first(place.path());
    for (int i = 0; i < 6; ++i) first.Send(envelopes[i]);
    first.WaitForAck(kAnna, 6);
  }
  ServiceHarness second(place.path());
  // The agent does not know how far the server came and sends everything again.
  for (const Envelope& envelope : envelopes) second.Send(envelope);
  EXPECT_EQ(second.WaitForAck(kAnna, 10).server_incarnation, 2u);
  EXPECT_EQ(Fingerprint(second.service->State()->ingest.atlas), Fingerprint(flight.atlas()));
}

TEST(AtlasService, RejectionsSurviveARestart) {
  const TemporaryStore place;
  Flight flight(kAnna);
  const Envelope bad = flight.NextWith({RemoveKeyframe{K(9000)}});
  {
    ServiceHarness first(place.path());
    first.Send(bad);
    EXPECT_EQ(first.WaitForAck(kAnna, 1).rejections.size(), 1u);
  }
  ServiceHarness second(place.path());
  second.Send(bad);
  const EditAck ack = second.WaitForAck(kAnna, 1);
  ASSERT_EQ(ack.rejections.size(), 1u);
  EXPECT_EQ(ack.rejections[0].reason, RejectionReason::kUnknownReference);
}

TEST(AtlasService, DiskFullStopsAcksKeepsServingSaysSoAndResumesWhenThereIsRoom) {
  const TemporaryStore place;
  ServiceOptions options;
  options.store.max_bytes = 1U << 20;
  ServiceHarness harness(place.path(), options);
  Flight flight(kAnna, {.keypoints = 500});
  std::vector<Envelope> envelopes;
  for (int i = 0; i < 100; ++i) envelopes.push_back(flight.Next());
  for (const Envelope& envelope : envelopes) harness.Send(envelope);
  harness.WaitForEvent(AtlasEventKind::kStoreFailed);

  // It still takes sessions in, and its state says what is wrong.
  Flight bert(kBert);
  harness.service->Submit(SessionAnnounced{bert.Announcement("hall"), {2, 200}});
  harness.WaitForEvent(AtlasEventKind::kSessionJoined);
  EXPECT_FALSE(harness.service->State()->store_error.empty());
  const std::uint64_t acknowledged = harness.AcknowledgedOf(kAnna);
  EXPECT_LT(acknowledged, envelopes.size());
  EXPECT_EQ(Stored(place.path()).position, acknowledged) << "not one more was acknowledged than is durable";

  harness.service->SetStoreQuota(0);
  harness.service->Tick();
  harness.WaitForEvent(AtlasEventKind::kStoreRecovered);
  for (const Envelope& envelope : envelopes) harness.Send(envelope);
  harness.WaitForAck(kAnna, envelopes.size());
  harness.service->Stop();
  EXPECT_TRUE(harness.service->State()->store_error.empty());
  const RecoveredAtlas stored = Stored(place.path());
  EXPECT_EQ(Fingerprint(stored.atlas), Fingerprint(flight.atlas()));
  EXPECT_EQ(stored.sessions.size(), 2u) << "the session that joined meanwhile is durable now, too";
}

TEST(AtlasService, SnapshotsTruncateTheJournalWhileEnvelopesComeIn) {
  const TemporaryStore place;
  ServiceHarness harness(place.path(), {.snapshot_envelopes = 10});
  Flight flight(kAnna);
  std::uint64_t sequence = 0;
  while (harness.service->LastSnapshot().written < 3) {
    harness.Send(flight.Next());
    harness.WaitForAck(kAnna, ++sequence);
  }
  harness.service->Stop();
  EXPECT_EQ(harness.service->LastSnapshot().error, "");
  const RecoveredAtlas stored = Stored(place.path());
  EXPECT_GT(stored.snapshot_position, 0u);
  EXPECT_LT(stored.replayed, sequence);
  EXPECT_EQ(Fingerprint(stored.atlas), Fingerprint(flight.atlas()));
}

TEST(AtlasService, StoppingAnswersWhatWasSubmitted) {
  const TemporaryStore place;
  ServiceHarness harness(place.path());
  Flight flight(kAnna);
  for (int i = 0; i < 30; ++i) harness.Send(flight.Next());
  harness.service->Stop();
  EXPECT_EQ(harness.AcknowledgedOf(kAnna), 30u);
  harness.Send(flight.Next());
  EXPECT_EQ(harness.AcknowledgedOf(kAnna), 30u) << "what comes later is dropped, and was never acknowledged";
}

TEST(AtlasService, AFullQueueMakesTheSenderWaitAndLosesNothing) {
  const TemporaryStore place;
  ServiceHarness harness(place.path(), {.queue_capacity = 1, .round_envelopes = 1});
  Flight flight(kAnna);
  for (int i = 0; i < 30; ++i) harness.Send(flight.Next());
  EXPECT_EQ(harness.WaitForAck(kAnna, 30).up_to, 30u);
}

EditsProposed Removing(LandmarkId landmark) {
  return {{"tidying"}, [landmark](ServerDraft& draft) { return draft.Try(RemoveLandmark{landmark}); }};
}

TEST(AtlasService, EditsOfTheServersOwnAreDurableBeforeTheAnswerAndRecoveryReplaysThem) {
  const TemporaryStore place;
  ServiceHarness harness(place.path());
  Flight flight(kAnna);
  harness.Send(flight.Next());
  const ProposalAnswer answer = harness.service->ProposeAndWait(Removing(L(1)));
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->cause.Text(), "tidying 2");
  const RecoveredAtlas stored = Stored(place.path());
  EXPECT_EQ(stored.position, 2u);
  EXPECT_EQ(stored.atlas.FindLandmark(L(1)), nullptr);
  EXPECT_EQ(Fingerprint(stored.atlas), Fingerprint(harness.service->State()->ingest.atlas));
  harness.Send(flight.Next());
  harness.WaitForAck(kAnna, 2);
  EXPECT_EQ(Fingerprint(Stored(place.path()).atlas), Fingerprint(harness.service->State()->ingest.atlas));
}

TEST(AtlasService, EditsOfTheServersOwnWaitForRoomOnTheDiskLikeEverythingElse) {
  const TemporaryStore place;
  ServiceOptions options;
  options.store.max_bytes = 1U << 20;
  ServiceHarness harness(place.path(), options);
  Flight flight(kAnna, {.keypoints = 500});
  harness.Send(flight.Next());
  harness.WaitForAck(kAnna, 1);
  for (int i = 0; i < 100; ++i) harness.Send(flight.Next());
  harness.WaitForEvent(AtlasEventKind::kStoreFailed);
  const auto declined = harness.service->ProposeAndWait(Removing(L(1)));
  ASSERT_FALSE(declined);
  EXPECT_EQ(declined.error().code, ErrorCode::kUnavailable);
  EXPECT_NE(harness.service->State()->ingest.atlas.FindLandmark(L(1)), nullptr);
  harness.service->SetStoreQuota(0);
  harness.service->Tick();
  EXPECT_TRUE(harness.service->ProposeAndWait(Removing(L(1))));
}

TEST(AtlasService, AfterItStoppedNothingIsProposed) {
  const TemporaryStore place;
  ServiceHarness harness(place.path());
  harness.service->Stop();
  const auto answer = harness.service->ProposeAndWait(Removing(L(1)));
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kUnavailable);
}

TEST(AtlasService, ASnapshotFromBeforeAChangeThatMayBeUndoneIsKept) {
  const TemporaryStore place;
  ServiceHarness harness(place.path(), {.snapshot_envelopes = 2});
  Flight flight(kAnna);
  std::uint64_t sequence = 0;
  harness.Send(flight.Next());
  harness.WaitForAck(kAnna, ++sequence);
  EditsProposed proposal = Removing(L(1));
  proposal.keep_before = true;
  ASSERT_TRUE(harness.service->ProposeAndWait(std::move(proposal)));
  while (harness.service->LastSnapshot().position < 4) {
    harness.Send(flight.Next());
    harness.WaitForAck(kAnna, ++sequence);
  }
  harness.service->Stop();
  EXPECT_EQ(harness.service->LastSnapshot().error, "");
  Store store = Store::OpenReadOnly(place.path()).value();
  EXPECT_EQ(store.database().Number("SELECT position FROM snapshots WHERE kept").value(), 1);
  EXPECT_EQ(store.database().Number("SELECT min(position) FROM server_edits").value(), 2);
  EXPECT_EQ(Fingerprint(Stored(place.path()).atlas), Fingerprint(harness.service->State()->ingest.atlas));
}

TEST(AtlasService, TimesOfWorkGoToTheStoreWithTheNextRoundAndTheRestWhenItStops) {
  const TemporaryStore place;
  ServiceHarness harness(place.path());
  Flight flight(kAnna);
  harness.service->Note({"merge", 200.0, 150.0, 1});
  harness.Send(flight.Next());
  harness.WaitForAck(kAnna, 1);
  EXPECT_EQ(Store::OpenReadOnly(place.path())->WorkTimes()->size(), 1u);
  harness.service->Note({"pose_graph", 20.0, 15.0, 2});
  harness.service->Stop();
  const auto times = Store::OpenReadOnly(place.path())->WorkTimes();
  ASSERT_EQ(times->size(), 2u);
  EXPECT_EQ(times->back().kind, "pose_graph");
}

TEST(AtlasService, OptionsOutOfRangeAreRefused) {
  const TemporaryStore place;
  EXPECT_FALSE(AtlasService::Open(place.path(), "hall", {.queue_capacity = 0}));
  EXPECT_FALSE(AtlasService::Open(place.path(), "hall", {.snapshot_envelopes = 0}));
}

}  // namespace
}  // namespace pangaea
