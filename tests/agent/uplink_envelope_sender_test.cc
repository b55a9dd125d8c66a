#include <gtest/gtest.h>

#include <vector>

#include "agent/uplink/envelope_sender.h"
#include "tests/agent/spill_map.h"

namespace pangaea {
namespace {

using std::chrono_literals::operator""ms;

class EnvelopeSenderTest : public ::testing::Test {
 protected:
  EnvelopeSenderTest() {
    retained_.OnServerPresent(true);
    for (std::uint64_t sequence = 1; sequence <= 3; ++sequence) {
      Envelope envelope;
      envelope.sequence = sequence;
      envelope.edits.resize(100);
      EXPECT_TRUE(retained_.Retain(std::move(envelope)));
    }
  }

  std::size_t room_ = 100;  // what the peers still take
  std::vector<std::uint64_t> written_;
  EnvelopeSender::Time now_;
  RetainedEdits retained_{{}, nullptr};
  EnvelopeSender sender_{[this](const Envelope& envelope) -> Status {
                           if (room_ == 0) return Fail(ErrorCode::kUnavailable, "the peers take nothing");
                           --room_;
                           written_.push_back(envelope.sequence);
                           return {};
                         },
                         [this] { return now_; }};
};

TEST_F(EnvelopeSenderTest, EverythingGoesOutInOrderAndIsCounted) {
  EXPECT_TRUE(sender_.Send(retained_));
  EXPECT_EQ(written_, (std::vector<std::uint64_t>{1, 2, 3}));
  EXPECT_EQ(sender_.envelopes(), 3U);
  EXPECT_EQ(sender_.bytes(), 300U);
  EXPECT_FALSE(sender_.deadline());
}

TEST_F(EnvelopeSenderTest, WhatPeersDidNotTakeIsSentAgainAfterThePauseAndNotBefore) {
  room_ = 1;
  EXPECT_FALSE(sender_.Send(retained_));
  ASSERT_EQ(sender_.deadline(), now_ + EnvelopeSender::kPause);
  room_ = 100;
  now_ += EnvelopeSender::kPause - 1ms;
  EXPECT_TRUE(sender_.Send(retained_));
  EXPECT_EQ(written_.size(), 1U);
  now_ += 1ms;
  EXPECT_TRUE(sender_.Send(retained_));
  EXPECT_EQ(written_, (std::vector<std::uint64_t>{1, 2, 3}));
  EXPECT_FALSE(sender_.deadline());
}

TEST_F(EnvelopeSenderTest, AnAnswerOfThePeersEndsThePause) {
  room_ = 0;
  EXPECT_FALSE(sender_.Send(retained_));
  room_ = 100;
  sender_.EndPause();
  EXPECT_TRUE(sender_.Send(retained_));
  EXPECT_EQ(written_.size(), 3U);
}

TEST_F(EnvelopeSenderTest, AnEnvelopeThatTheSpillSinkLostIsAnErrorAndIsTriedAgainAfterThePause) {
  testing::SpillMap spill;
  RetainedEdits retained({.memory_bytes = 1}, &spill);
  retained.OnServerPresent(true);
  Envelope envelope;
  envelope.sequence = 1;
  envelope.edits.resize(100);
  ASSERT_TRUE(retained.Retain(envelope));
  spill.envelopes.clear();
  EXPECT_FALSE(sender_.Send(retained));
  EXPECT_EQ(sender_.deadline(), now_ + EnvelopeSender::kPause);
  spill.envelopes[1] = envelope;
  now_ += EnvelopeSender::kPause;
  EXPECT_TRUE(sender_.Send(retained));
  EXPECT_EQ(written_, (std::vector<std::uint64_t>{1}));
}

}  // namespace
}  // namespace pangaea
