#include "server/ingest/ingest_round.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "common/base/hash.h"
#include "common/map/consistency.h"
#include "common/map/digest.h"
#include "tests/map/small_world.h"
#include "tests/server/flight.h"
#include "tests/server/ingest_harness.h"

namespace pangaea {
namespace {

constexpr Sender kIntruder{2, 200};

TEST(IngestRound, AcceptedEnvelopesAreJournaledAcknowledgedAndAppliedInOrder) {
  Ingest ingest;
  Flight flight(kAnna);
  const IngestOutcome outcome = ingest.Take({flight.Next(), flight.Next(), flight.Next()});
  ASSERT_EQ(outcome.batch.entries.size(), 3u);
  for (std::uint64_t i = 0; i < 3; ++i) {
    EXPECT_EQ(outcome.batch.entries[i].position, i + 1);
    EXPECT_EQ(outcome.batch.entries[i].envelope.sequence, i + 1);
  }
  ASSERT_EQ(outcome.acks.size(), 1u);
  EXPECT_EQ(outcome.acks[0].up_to, 3u);
  ASSERT_EQ(outcome.batch.sessions.size(), 1u);
  EXPECT_EQ(outcome.batch.sessions[0].acknowledged, 3u);
  EXPECT_EQ(outcome.batch.sessions[0].joined_unix_ns, 1234);
  EXPECT_EQ(Digest(ingest.state().atlas), Digest(flight.atlas()));
  EXPECT_TRUE(CheckConsistency(ingest.state().atlas).empty());
}

TEST(IngestRound, CountsTheMapsThatASessionsAgentClosed) {
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Take({flight.Next()});
  EXPECT_EQ(ingest.state().sessions.at(kAnna).closed_maps(), 0u);
  ingest.Take({flight.NextWith({CloseMap{M(1)}}), flight.NextWith({CloseMap{M(7)}})});
  EXPECT_EQ(ingest.state().sessions.at(kAnna).closed_maps(), 1u) << "one that is not there is rejected";
}

TEST(IngestRound, LeavesTheStateItStartedFromUnchanged) {
  Flight flight(kAnna);
  const IngestState before;
  IngestRound round(before, {}, 0);
  round.Take(EnvelopeArrived{flight.Next(), kAgent});
  const IngestOutcome outcome = std::move(round).Finish();
  EXPECT_EQ(before.atlas.keyframe_count(), 0u);
  EXPECT_TRUE(before.sessions.empty());
  EXPECT_EQ(outcome.state.atlas.keyframe_count(), 1u);
}

TEST(IngestRound, DuplicateMessageIsAcknowledgedAgainAndChangesNothing) {
  Ingest ingest;
  Flight flight(kAnna);
  const Envelope first = flight.Next();
  ingest.Take({first});
  const IngestOutcome outcome = ingest.Take({first, first});
  EXPECT_TRUE(outcome.batch.empty());
  ASSERT_EQ(outcome.acks.size(), 1u);
  EXPECT_EQ(outcome.acks[0].up_to, 1u);
  EXPECT_EQ(Digest(ingest.state().atlas), Digest(flight.atlas()));
}

TEST(IngestRound, LateOrReorderedMessageIsAGapAndTheLastAckIsRepeated) {
  Ingest ingest;
  Flight flight(kAnna);
  const Envelope first = flight.Next();
  const Envelope second = flight.Next();
  const Envelope third = flight.Next();
  const IngestOutcome outcome = ingest.Take({first, third, second});
  EXPECT_EQ(outcome.batch.entries.size(), 2u) << "the third came before the second and has to come again";
  EXPECT_EQ(outcome.acks.at(0).up_to, 2u);
  EXPECT_EQ(ingest.Take({third}).acks.at(0).up_to, 3u);
  EXPECT_EQ(Digest(ingest.state().atlas), Digest(flight.atlas()));
}

TEST(IngestRound, AnyOrderWithResendingGivesTheSameAtlas) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    Ingest ingest;
    Flight flight(kAnna, {.keypoints = 10, .observed = 5, .created = 5});
    std::vector<Envelope> envelopes;
    for (int i = 0; i < 20; ++i) envelopes.push_back(flight.Next());
    std::mt19937 random(seed);
    while (ingest.state().position < envelopes.size()) {
      std::vector<Envelope> flightful;
      for (int i = 0; i < 8; ++i) flightful.push_back(envelopes[random() % envelopes.size()]);
      flightful.push_back(envelopes[ingest.state().position]);
      ingest.Take(flightful);
    }
    EXPECT_EQ(Digest(ingest.state().atlas), Digest(flight.atlas()));
    EXPECT_EQ(ingest.state().atlas.version(), flight.atlas().version());
  }
}

TEST(IngestRound, ForeignMessageUnderALiveSessionsIdIsIgnoredAndReportedOnce) {
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Take({flight.Next()});
  Flight impostor(kAnna);
  impostor.Next();
  const Envelope forged = impostor.Next();
  const IngestOutcome first = ingest.Take({forged}, kIntruder);
  EXPECT_TRUE(first.batch.empty());
  EXPECT_TRUE(first.acks.empty());
  ASSERT_EQ(first.events.size(), 1u);
  EXPECT_EQ(first.events[0].kind, AtlasEventKind::kRejected);
  EXPECT_TRUE(ingest.Take({forged}, kIntruder).events.empty()) << "no flood of events";
  EXPECT_EQ(ingest.Take({flight.Next()}).acks.at(0).up_to, 2u);
}

TEST(IngestRound, EnvelopeWithAWrongChecksumIsRejectedWhole) {
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Take({flight.Next()});
  Envelope spoiled = flight.NextWith({CloseMap{M(1)}});
  spoiled.edits.back() ^= std::byte{1};
  ingest.ExpectRejected(flight, spoiled, RejectionReason::kChecksum);
}

TEST(IngestRound, UnknownWireVersionIsRejectedWhole) {
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Take({flight.Next()});
  Envelope newer = flight.NextWith({CloseMap{M(1)}});
  newer.wire_version = kWireVersion + 1;
  ingest.ExpectRejected(flight, newer, RejectionReason::kUnknownWireVersion);
}

TEST(IngestRound, TruncatedMessageIsRejectedWhole) {
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Take({flight.Next()});
  Envelope truncated = flight.NextWith({CloseMap{M(1)}, RemoveLandmark{L(1)}});
  truncated.edits.pop_back();
  truncated.checksum = Hash64(truncated.edits);
  ingest.ExpectRejected(flight, truncated, RejectionReason::kMalformed);
}

TEST(IngestRound, OversizedMessageIsRejectedWhole) {
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Take({flight.Next()});
  Envelope huge = flight.NextWith({});
  huge.edits.resize(kMaxEnvelopeBytes + 1);
  huge.checksum = Hash64(huge.edits);
  ingest.ExpectRejected(flight, huge, RejectionReason::kTooLarge);
}

TEST(IngestRound, ALandmarkThatRefersToAnUnknownKeyframeIsRejectedWhole) {
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Take({flight.Next()});
  const Envelope envelope = flight.NextWith({RemoveLandmark{L(1)}, AddLandmark{L(9000), K(9000), 0, {0.0, 0.0, 4.0}}});
  ingest.ExpectRejected(flight, envelope, RejectionReason::kUnknownReference);
}

// An agent forgets what the server has, and says it anew when it sees it again.
TEST(IngestRound, ALandmarkThatIsSaidAnewIsSeenFromOneMoreKeyframe) {
  Ingest ingest;
  Flight flight(kAnna, {.keypoints = 44});
  ingest.Take({flight.Next(), flight.Next(), flight.Next()});
  ASSERT_EQ(ingest.state().correction, 0u) << "the server has changed nothing itself";
  ASSERT_FALSE(ingest.state().atlas.FindKeyframe(K(3))->landmarks[40].valid());
  const std::size_t observers = ingest.state().atlas.FindLandmark(L(1))->observations.size();
  const AddLandmark anew{L(1), K(3), 40, {0.0, 0.0, 4.0}};
  const IngestOutcome outcome = ingest.Take({MakeEnvelope(kAnna, 4, 0, std::vector<MapEdit>{anew})});
  EXPECT_TRUE(outcome.batch.rejections.empty());
  EXPECT_EQ(ingest.state().atlas.FindKeyframe(K(3))->landmarks[40], L(1));
  EXPECT_EQ(ingest.state().atlas.FindLandmark(L(1))->observations.size(), observers + 1);
  EXPECT_TRUE(CheckConsistency(ingest.state().atlas).empty());
}

TEST(IngestRound, NanPoseIsRejectedWhole) {
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Take({flight.Next()});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Rigid3d pose(Eigen::Quaterniond::Identity(), {nan, 0.0, 0.0});
  const Envelope envelope = flight.NextWith({RemoveLandmark{L(1)}, MoveKeyframes{{{K(1), pose}}}});
  const IngestOutcome outcome = ingest.Take({envelope});
  EXPECT_TRUE(outcome.batch.entries.empty());
  EXPECT_EQ(outcome.acks.at(0).rejections.size(), 1u);
  EXPECT_NE(ingest.state().atlas.FindLandmark(L(1)), nullptr) << "the valid edit before it must not be applied either";
}

TEST(IngestRound, ASessionThatClaimsAnothersIdsIsRejectedWhole) {
  Ingest ingest;
  Flight bert(kBert);
  ingest.Take({bert.Next()}, kIntruder);
  Flight anna(kAnna);
  ingest.Take({anna.Next()});
  const KeyframeId stolen = K(7, kBert);
  ingest.Take({});
  const IngestOutcome outcome =
      ingest.Take({anna.NextWith({AddKeyframe{stolen, M(1), K(1), Rigid3d(), MakeData(20)}}),
                   anna.NextWith({MoveKeyframes{{{K(1, kBert), MakePose(0.1, 1.0, 0.0, 0.0)}}}}),
                   anna.NextWith({RemoveLandmark{L(1, kBert)}}), anna.NextWith({CloseMap{M(1, kBert)}})});
  EXPECT_TRUE(outcome.batch.entries.empty());
  ASSERT_EQ(outcome.acks.at(0).rejections.size(), 4u);
  for (const Rejection& rejection : outcome.acks[0].rejections) {
    EXPECT_EQ(rejection.reason, RejectionReason::kForeignSession) << rejection.text;
  }
  EXPECT_EQ(DigestOfSession(ingest.state().atlas, kBert), DigestOfSession(bert.atlas(), kBert));
}

TEST(IngestRound, AMessageWithoutSessionOrNumberIsCountedAndNotAnswered) {
  Ingest ingest;
  Flight flight(kAnna);
  Envelope nobody = flight.Next();
  nobody.session = 0;
  Envelope unnumbered = flight.Next();
  unnumbered.sequence = 0;
  const IngestOutcome outcome = ingest.Take({nobody, unnumbered});
  EXPECT_TRUE(outcome.batch.empty());
  EXPECT_TRUE(outcome.acks.empty());
  EXPECT_EQ(ingest.state().refused, 2u);
}

TEST(IngestRound, InventedSessionsBeyondTheLimitAreRefused) {
  IngestRound round(IngestState(), {.max_sessions = 2}, 0);
  for (SessionId session = 1; session <= 5; ++session) round.Take(EnvelopeArrived{Flight(session).Next(), kAgent});
  const IngestOutcome outcome = std::move(round).Finish();
  EXPECT_EQ(outcome.state.sessions.size(), 2u);
  EXPECT_EQ(outcome.state.refused, 3u);
}

TEST(IngestRound, RandomBytesNeverBecomePartOfTheAtlas) {
  std::mt19937 random(1);
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Take({flight.Next()});
  for (int i = 0; i < 300; ++i) {
    Envelope envelope = flight.NextWith({RemoveLandmark{L(1)}, CloseMap{M(1)}});
    envelope.edits[random() % envelope.edits.size()] = static_cast<std::byte>(random());
    if (random() % 2 == 0) envelope.edits.resize(random() % 64, std::byte{0x5a});
    if (random() % 4 != 0) envelope.checksum = Hash64(envelope.edits);
    ingest.Take({envelope});
  }
  EXPECT_TRUE(CheckConsistency(ingest.state().atlas).empty());
  EXPECT_EQ(ingest.state().sessions.at(kAnna).record().acknowledged, 301u) << "each was answered, one way or the other";
}

TEST(IngestRound, AnAckForADuplicateRepeatsTheRejectionsTheAgentMayHaveMissed) {
  Ingest ingest;
  Flight flight(kAnna);
  const Envelope bad = flight.NextWith({RemoveKeyframe{K(9000)}});
  ingest.Take({bad});
  const IngestOutcome outcome = ingest.Take({bad});
  ASSERT_EQ(outcome.acks.size(), 1u);
  ASSERT_EQ(outcome.acks[0].rejections.size(), 1u);
  EXPECT_EQ(outcome.acks[0].rejections[0].sequence, 1u);
}

std::vector<AtlasEventKind> Kinds(const IngestOutcome& outcome) {
  std::vector<AtlasEventKind> kinds;
  for (const AtlasEvent& event : outcome.events) kinds.push_back(event.kind);
  return kinds;
}

TEST(IngestRound, ReportsASessionsLifeAsEvents) {
  using enum AtlasEventKind;
  using Events = std::vector<AtlasEventKind>;
  Ingest ingest;
  Flight flight(kAnna);
  SessionAnnouncement announcement = flight.Announcement("hall");
  EXPECT_EQ(Kinds(ingest.Announce(announcement)), Events{kSessionJoined});
  EXPECT_EQ(Kinds(ingest.Announce(announcement)), Events{}) << "it joined already";
  EXPECT_EQ(Kinds(ingest.Take({flight.Next()})), Events{kNewMap});
  EXPECT_EQ(Kinds(ingest.Take({flight.NextWith({CloseMap{M(1)}})})), Events{kMapClosed});
  announcement.closed = true;
  EXPECT_EQ(Kinds(ingest.Announce(announcement)), Events{kSessionClosed});
  EXPECT_EQ(Kinds(ingest.Lose(kAgent.writer)), Events{}) << "it ended in order before";
}

TEST(IngestRound, AnAgentThatVanishesIsReportedAndItsSessionStays) {
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Announce(flight.Announcement("hall"));
  ingest.Take({flight.Next()});
  const IngestOutcome outcome = ingest.Lose(kAgent.writer);
  EXPECT_EQ(Kinds(outcome), std::vector{AtlasEventKind::kSessionLost});
  EXPECT_FALSE(ingest.state().sessions.at(kAnna).alive());
  EXPECT_EQ(Digest(ingest.state().atlas), Digest(flight.atlas()));
}

TEST(IngestRound, RecordsThatWereNotSavedAreSavedWithTheNextRound) {
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Announce(flight.Announcement("hall"));
  IngestRound round(ingest.state(), {}, 0);
  const IngestOutcome outcome = std::move(round).Finish({kAnna});
  ASSERT_EQ(outcome.batch.sessions.size(), 1u);
  EXPECT_EQ(outcome.batch.sessions[0].announcement.session, kAnna);
}

}  // namespace
}  // namespace pangaea
