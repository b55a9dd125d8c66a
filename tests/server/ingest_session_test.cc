#include "server/ingest/ingest_session.h"

#include <gtest/gtest.h>

namespace pangaea {
namespace {

constexpr Sender kAgent{1, 100};
constexpr Sender kIntruder{2, 200};

IngestSession AfterFive() {
  SessionRecord record;
  record.announcement.session = 7;
  record.acknowledged = 5;
  return IngestSession(record);
}

TEST(IngestSession, OnlyTheEnvelopeAfterTheLastOneIsNext) {
  IngestSession session = AfterFive();
  EXPECT_EQ(session.Admit(5, kAgent), Admission::kDuplicate);
  EXPECT_EQ(session.Admit(6, kAgent), Admission::kNext);
  EXPECT_EQ(session.Admit(7, kAgent), Admission::kGap);
  session.Accept();
  EXPECT_EQ(session.Admit(6, kAgent), Admission::kDuplicate);
  EXPECT_EQ(session.Admit(7, kAgent), Admission::kNext);
}

TEST(IngestSession, ARejectedEnvelopeIsNotDueAgain) {
  IngestSession session = AfterFive();
  session.Reject({6, RejectionReason::kChecksum, "damaged"});
  EXPECT_EQ(session.Admit(6, kAgent), Admission::kDuplicate);
  EXPECT_EQ(session.Admit(7, kAgent), Admission::kNext);
  EXPECT_EQ(session.record().rejected, 1u);
  ASSERT_EQ(session.RecentRejections().size(), 1u);
}

TEST(IngestSession, BelongsToTheFirstLiveParticipantUntilItsWritersAreLost) {
  IngestSession session = AfterFive();
  ASSERT_EQ(session.Admit(6, kAgent), Admission::kNext);
  EXPECT_EQ(session.Admit(6, kIntruder), Admission::kForeign);
  EXPECT_FALSE(session.Announce({}, kIntruder));
  EXPECT_EQ(session.foreign(), 2u);
  session.LoseWriter(kIntruder.writer);
  EXPECT_EQ(session.Admit(6, kIntruder), Admission::kForeign);
  session.LoseWriter(kAgent.writer);
  EXPECT_EQ(session.Admit(6, kIntruder), Admission::kNext) << "a resumed agent is a new participant";
}

TEST(IngestSession, TheAnnouncerAloneMaySendEdits) {
  IngestSession session = AfterFive();
  ASSERT_TRUE(session.Announce({}, kAgent));
  EXPECT_EQ(session.Admit(6, kIntruder), Admission::kForeign);
  EXPECT_EQ(session.Admit(6, {3, kAgent.participant}), Admission::kNext) << "another writer of the same participant";
}

TEST(IngestSession, WhatADeadSenderWroteCountsButClaimsNothing) {
  IngestSession session = AfterFive();
  EXPECT_EQ(session.Admit(6, {1, 0}), Admission::kNext);
  EXPECT_FALSE(session.alive());
  EXPECT_EQ(session.Admit(6, kAgent), Admission::kNext);
  EXPECT_TRUE(session.alive());
}

TEST(IngestSession, IsNotAliveOnceItsAgentSaidThatItEnded) {
  IngestSession session = AfterFive();
  SessionAnnouncement announcement;
  ASSERT_TRUE(session.Announce(announcement, kAgent));
  EXPECT_TRUE(session.alive());
  announcement.closed = true;
  ASSERT_TRUE(session.Announce(announcement, kAgent));
  EXPECT_FALSE(session.alive());
}

TEST(IngestSession, RemembersTheNewestRejectionsAlone) {
  IngestSession session = AfterFive();
  for (std::uint64_t sequence = 6; sequence < 106; ++sequence) session.Reject({sequence, {}, ""});
  const auto recent = session.RecentRejections();
  ASSERT_FALSE(recent.empty());
  EXPECT_LT(recent.size(), 100u);
  EXPECT_EQ(recent.back().sequence, 105u);
}

}  // namespace
}  // namespace pangaea
