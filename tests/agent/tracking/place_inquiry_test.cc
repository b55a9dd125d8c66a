#include "agent/tracking/place_inquiry.h"

#include <gtest/gtest.h>

namespace pangaea {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr KeyframeId kPlace{9, 4};

RelocalizationAnswer Answer(std::uint64_t request, bool found) {
  return {1, request, found, {9, 1}, kPlace, Rigid3d({1, 0, 0, 0}, {0.1, 0.2, 0.3}), 80};
}

TEST(PlaceInquiry, AsksAgainWhenNoAnswerComesOrSoonAfterTheServerDidNotKnowThePlace) {
  PlaceInquiry inquiry;
  EXPECT_EQ(inquiry.Ask(0), 1U);
  EXPECT_FALSE(inquiry.Ask(450 * kMillisecond));
  EXPECT_EQ(inquiry.Ask(500 * kMillisecond), 2U);
  EXPECT_FALSE(inquiry.Take(Answer(2, false)));
  EXPECT_FALSE(inquiry.Ask(600 * kMillisecond));
  EXPECT_EQ(inquiry.Ask(650 * kMillisecond), 3U);
}

TEST(PlaceInquiry, AnAnswerToAnOlderQuestionOfTheSameLossStillSaysWhereTheCameraWas) {
  PlaceInquiry inquiry;
  inquiry.Ask(0);
  inquiry.Ask(500 * kMillisecond);
  const auto hint = inquiry.Take(Answer(1, true));
  ASSERT_TRUE(hint);
  EXPECT_EQ(hint->keyframe, kPlace);
  EXPECT_EQ(hint->camera_from_keyframe.translation().z(), 0.3);
  EXPECT_FALSE(inquiry.Ask(700 * kMillisecond)) << "the newest is still under way";
}

TEST(PlaceInquiry, WhileAPlaceIsOnItsWayItDoesNotAskForAnother) {
  PlaceInquiry inquiry;
  inquiry.Ask(0);
  ASSERT_TRUE(inquiry.Take(Answer(1, true)));
  EXPECT_FALSE(inquiry.Ask(900 * kMillisecond));
  EXPECT_EQ(inquiry.Ask(1000 * kMillisecond), 2U);
}

TEST(PlaceInquiry, AnAnswerThatComesAfterTheCameraWasFoundMeansNothing) {
  PlaceInquiry inquiry;
  inquiry.Ask(0);
  inquiry.End();
  EXPECT_FALSE(inquiry.Take(Answer(1, true)));
  EXPECT_EQ(inquiry.Ask(100 * kMillisecond), 2U) << "a new loss asks at once";
  EXPECT_TRUE(inquiry.Take(Answer(2, true)));
}

TEST(PlaceInquiry, AnAnswerToWhatWasNeverAskedIsIgnored) {
  PlaceInquiry inquiry;
  EXPECT_FALSE(inquiry.Take(Answer(1, true)));
  inquiry.Ask(0);
  EXPECT_FALSE(inquiry.Take(Answer(2, true)));
}

}  // namespace
}  // namespace pangaea
