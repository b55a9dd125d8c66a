#include <gtest/gtest.h>

#include "common/map/consistency.h"
#include "server/ingest/ingest_round.h"
#include "tests/map/small_world.h"
#include "tests/server/flight.h"
#include "tests/server/ingest_harness.h"

namespace pangaea {
namespace {

EditsProposed Proposing(std::vector<MapEdit> edits) {
  return {{"tidying"}, [edits = std::move(edits)](ServerDraft& draft) {
            for (const MapEdit& edit : edits) {
              if (!draft.Try(edit)) return Status(Fail(ErrorCode::kRefused, "it does not fit"));
            }
            return Status();
          }};
}

TEST(IngestRound, EditsOfTheServersOwnStandInTheJournalAmongTheEnvelopesWithTheirCause) {
  Ingest ingest;
  Flight flight(kAnna);
  IngestRound round(ingest.state(), {}, 1234);
  round.Take(EnvelopeArrived{flight.Next(), kAgent});
  round.Take(Proposing({RemoveLandmark{L(1)}}));
  round.Take(EnvelopeArrived{flight.Next(), kAgent});
  const IngestOutcome outcome = std::move(round).Finish();
  ASSERT_EQ(outcome.batch.server_edits.size(), 1u);
  EXPECT_EQ(outcome.batch.server_edits[0].position, 2u);
  EXPECT_EQ(outcome.batch.server_edits[0].cause, "tidying 2");
  EXPECT_EQ(outcome.batch.entries.at(1).position, 3u);
  ASSERT_TRUE(outcome.answers.at(0));
  EXPECT_EQ(outcome.answers[0]->position, 2u);
  EXPECT_EQ(outcome.state.atlas.FindLandmark(L(1)), nullptr);
}

TEST(IngestRound, EditsOfTheServersOwnAreMadeFromTheAtlasAsItIsThen) {
  Ingest ingest;
  Flight flight(kAnna);
  IngestRound round(ingest.state(), {}, 1234);
  round.Take(EnvelopeArrived{flight.Next(), kAgent});
  std::size_t keyframes = 0;
  const auto look = [&keyframes](ServerDraft& draft) {
    keyframes = draft.atlas().keyframe_count();
    return Status();
  };
  round.Take(EditsProposed{{"merge"}, look});
  const IngestOutcome outcome = std::move(round).Finish();
  EXPECT_EQ(keyframes, 1u);
  EXPECT_TRUE(outcome.batch.server_edits.empty());
  ASSERT_TRUE(outcome.answers.at(0));
  EXPECT_EQ(outcome.answers[0]->position, 0u);
}

TEST(IngestRound, EditsOfTheServersOwnOfWhichOneDoesNotFitChangeNothing) {
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Take({flight.Next()});
  const IngestOutcome outcome = ingest.Propose(Proposing({RemoveLandmark{L(1)}, RemoveKeyframe{K(9000)}}));
  ASSERT_FALSE(outcome.answers.at(0));
  EXPECT_EQ(outcome.answers[0].error().code, ErrorCode::kRefused);
  EXPECT_TRUE(outcome.batch.empty());
  EXPECT_EQ(Fingerprint(ingest.state().atlas), Fingerprint(flight.atlas()));
}

TEST(IngestRound, EditsThatMayBeUndoneCarryTheAtlasBeforeThemAndTheirEventNamesTheCause) {
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Take({flight.Next()});
  EditsProposed proposal = Proposing({RemoveLandmark{L(1)}});
  proposal.keep_before = true;
  proposal.event = AtlasEvent{{}, AtlasEventKind::kCulled, "1 landmark", 0, 0};
  const IngestOutcome outcome = ingest.Propose(std::move(proposal));
  ASSERT_EQ(outcome.kept.size(), 1u);
  EXPECT_EQ(outcome.kept[0].position, 1u);
  EXPECT_EQ(Fingerprint(outcome.kept[0].atlas), Fingerprint(flight.atlas()));
  ASSERT_EQ(outcome.events.size(), 1u);
  EXPECT_EQ(outcome.events[0].text, "tidying 2: 1 landmark");
}

// The server found that two landmarks of Anna are one, and that a keyframe sees a landmark which its agent did not see.
TEST(IngestRound, WhereAgentAndServerDisagreeAboutAKeypointTheServersWordStands) {
  Ingest ingest;
  Flight flight(kAnna, {.keypoints = 44});
  ingest.Take({flight.Next(), flight.Next(), flight.Next(), flight.Next()});
  ASSERT_TRUE(ingest.Propose(Proposing({AddObservation{L(1), K(3), 40}})).answers.at(0));
  const Envelope other = MakeEnvelope(kAnna, 5, 0, std::vector<MapEdit>{AddObservation{L(2), K(3), 40}});
  const Envelope created = MakeEnvelope(kAnna, 6, 0, std::vector<MapEdit>{AddLandmark{L(900), K(3), 40, {0, 0, 4}}});
  const Envelope late = MakeEnvelope(kAnna, 7, 0, std::vector<MapEdit>{AddObservation{L(900), K(4), 41}});
  const IngestOutcome outcome = ingest.Take({other, created, late});
  EXPECT_TRUE(outcome.batch.rejections.empty());
  const Atlas& atlas = ingest.state().atlas;
  EXPECT_EQ(atlas.FindKeyframe(K(3))->landmarks[40], L(1));
  EXPECT_EQ(atlas.Resolve(L(900)), L(1)) << "what is new at that keypoint is what is there";
  EXPECT_EQ(atlas.FindKeyframe(K(4))->landmarks[41], L(1));
  EXPECT_TRUE(CheckConsistency(atlas).empty());
}

TEST(IngestRound, WhatBelongsToAnEarlierCauseCarriesItsNumber) {
  Ingest ingest;
  Flight flight(kAnna);
  ingest.Take({flight.Next(), flight.Next()});
  EditsProposed proposal = Proposing({RemoveLandmark{L(1)}});
  proposal.cause.number = 1;
  EXPECT_EQ(ingest.Propose(std::move(proposal)).batch.server_edits.at(0).cause, "tidying 1");
}

}  // namespace
}  // namespace pangaea
