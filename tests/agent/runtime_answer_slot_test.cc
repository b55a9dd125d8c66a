#include <gtest/gtest.h>

#include "agent/runtime/answer_slot.h"

namespace pangaea {
namespace {

RelocalizationAnswer Answer(std::uint64_t request, bool found) {
  RelocalizationAnswer answer;
  answer.request = request;
  answer.found = found;
  return answer;
}

TEST(AnswerSlot, AnAnswerIsTakenOnce) {
  AnswerSlot slot;
  EXPECT_FALSE(slot.Take());
  slot.Put(Answer(1, false));
  ASSERT_EQ(slot.Take().value().request, 1u);
  EXPECT_FALSE(slot.Take());
}

TEST(AnswerSlot, TheNewestOfAKindStaysAndOneThatFoundThePlaceBeforeOneThatDidNot) {
  AnswerSlot slot;
  slot.Put(Answer(1, false));
  slot.Put(Answer(2, true));
  slot.Put(Answer(3, false));
  EXPECT_EQ(slot.Take().value().request, 2u);
  slot.Put(Answer(4, true));
  slot.Put(Answer(5, true));
  EXPECT_EQ(slot.Take().value().request, 5u);
}

}  // namespace
}  // namespace pangaea
