#include "server/atlas/relocalization_agenda.h"

#include <gtest/gtest.h>

namespace pangaea {
namespace {

constexpr Sender kAnnasAgent{1, 100};

PlaceQuestion Question(SessionId session, std::uint64_t request, bool stereo = true) {
  auto frame = std::make_shared<KeyframeData>();
  frame->camera = {752, 480, 450.0, 450.0, 375.5, 239.5, stereo ? 0.11 : 0.0};
  return {{session, request, frame}, kAnnasAgent};
}

// A living session with a stereo camera.
IngestState StateWith(SessionId session) {
  SessionAnnouncement announcement;
  announcement.session = session;
  announcement.ideal_camera = Question(session, 1).request.frame->camera;
  IngestSession living{SessionRecord{}};
  EXPECT_TRUE(living.Announce(announcement, kAnnasAgent));
  IngestState state;
  state.sessions.emplace(session, living);
  return state;
}

TEST(RelocalizationAgenda, OfASessionTheNewestQuestionIsAnswered) {
  RelocalizationAgenda agenda;
  EXPECT_TRUE(agenda.Put(Question(1, 1)));
  EXPECT_TRUE(agenda.Put(Question(1, 3)));
  EXPECT_TRUE(agenda.Put(Question(1, 2)));  // came late
  EXPECT_EQ(agenda.waiting(), 1U);
  EXPECT_EQ(agenda.Next()->request.request, 3U);
  EXPECT_FALSE(agenda.Next());
}

TEST(RelocalizationAgenda, SessionsTakeTurnsHoweverOftenOneAsks) {
  RelocalizationAgenda agenda;
  agenda.Put(Question(1, 1));
  agenda.Put(Question(2, 1));
  EXPECT_EQ(agenda.Next()->request.session, 1U);
  agenda.Put(Question(1, 2));
  EXPECT_EQ(agenda.Next()->request.session, 2U);
  EXPECT_EQ(agenda.Next()->request.session, 1U);
}

TEST(RelocalizationAgenda, MoreSessionsThanThereIsRoomForAreDropped) {
  RelocalizationAgenda agenda;
  for (SessionId session = 1; session <= RelocalizationAgenda::kMostSessions; ++session) {
    EXPECT_TRUE(agenda.Put(Question(session, 1)));
  }
  EXPECT_FALSE(agenda.Put(Question(1000, 1)));
  EXPECT_TRUE(agenda.Put(Question(5, 2)));
  EXPECT_EQ(agenda.waiting(), RelocalizationAgenda::kMostSessions);
}

TEST(RelocalizationAgenda, OnlyTheSessionsOwnAgentMayAsk) {
  const IngestState state = StateWith(7);
  EXPECT_TRUE(CheckQuestion(state, Question(7, 1)));
  EXPECT_FALSE(CheckQuestion(state, Question(8, 1)));
  PlaceQuestion foreign = Question(7, 1);
  foreign.sender.participant = 101;
  EXPECT_FALSE(CheckQuestion(state, foreign));
  foreign.sender.participant = 0;  // gone by now
  EXPECT_FALSE(CheckQuestion(state, foreign));
}

TEST(RelocalizationAgenda, AFrameOfAnotherKindOfCameraOrNoneIsRefused) {
  const IngestState state = StateWith(7);
  EXPECT_FALSE(CheckQuestion(state, Question(7, 1, false)));
  PlaceQuestion empty = Question(7, 1);
  empty.request.frame = nullptr;
  EXPECT_FALSE(CheckQuestion(state, empty));
}

}  // namespace
}  // namespace pangaea
