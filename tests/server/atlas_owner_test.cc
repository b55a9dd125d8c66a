#include "server/runtime/atlas_owner.h"

#include <gtest/gtest.h>

#include "tests/map/small_world.h"
#include "tests/server/flight.h"
#include "tests/server/temporary_store.h"

namespace pangaea {
namespace {

// An owner on the test's own thread, and what it gave out.
class AtlasOwnerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = AtlasOwner::Open(place_.path(), "hall", {});
    ASSERT_TRUE(opened) << opened.error().message;
    owner_ = std::move(*opened);
    owner_->Start({[this](const EditAck& ack) { OnAck(ack); }, [](const AtlasEvent&) {}, [this] { ++changes_; },
                   [](const Error& error) { ADD_FAILURE() << error.message; }});
  }
  void TearDown() override { owner_->Stop(); }

  void Run(std::vector<AtlasJob> jobs) { owner_->Run(std::move(jobs)); }
  static AtlasJob Sent(Envelope envelope) { return InputJob{EnvelopeArrived{std::move(envelope), {1, 100}}, {}}; }

  std::vector<EditAck> acks_;
  std::vector<std::uint64_t> durable_;  // the position in the store when each of them went out
  int changes_ = 0;
  std::unique_ptr<AtlasOwner> owner_;

 private:
  void OnAck(const EditAck& ack) {
    acks_.push_back(ack);
    auto store = Store::OpenReadOnly(place_.path());
    durable_.push_back(RecoverAtlas(*store)->position);
    EXPECT_EQ(owner_->State()->ingest.position, durable_.back()) << "and the state has it";
  }

  const TemporaryStore place_{};
};

TEST_F(AtlasOwnerTest, ARoundIsDurableAndPublishedBeforeItIsAnswered) {
  Flight flight(kAnna);
  Run({Sent(flight.Next()), Sent(flight.Next())});
  Run({Sent(flight.Next())});
  ASSERT_EQ(acks_.size(), 2U) << "one a round";
  EXPECT_EQ(acks_[0].up_to, 2U);
  EXPECT_EQ(acks_[1].up_to, 3U);
  EXPECT_EQ(durable_, (std::vector<std::uint64_t>{2, 3}));
  EXPECT_EQ(changes_, 2);
  EXPECT_EQ(Fingerprint(owner_->State()->ingest.atlas), Fingerprint(flight.atlas()));
}

TEST_F(AtlasOwnerTest, AcksThatAreWantedAgainComeAfterWhatTheSameRoundBrought) {
  Flight flight(kAnna);
  const SessionAnnouncement announcement = flight.Announcement("hall");
  Run({InputJob{SessionAnnounced{announcement, {1, 100}}, {}}, AckJob{}, Sent(flight.Next())});
  ASSERT_EQ(acks_.size(), 2U);
  EXPECT_EQ(acks_[1].up_to, 1U);
  EXPECT_EQ(acks_[1].server_incarnation, owner_->incarnation());
}

TEST_F(AtlasOwnerTest, ATickAloneChangesNothingThatOthersWaitFor) {
  Run({TickJob{}});
  EXPECT_TRUE(acks_.empty());
  EXPECT_EQ(changes_, 0);
}

TEST_F(AtlasOwnerTest, WhatCannotBeTakenBackLeavesAllAsItWas) {
  Flight flight(kAnna);
  Run({Sent(flight.Next())});
  EXPECT_FALSE(owner_->TakeBack("merge 17"));
  EXPECT_EQ(Fingerprint(owner_->State()->ingest.atlas), Fingerprint(flight.atlas()));
  Run({Sent(flight.Next())});
  EXPECT_EQ(acks_.back().up_to, 2U);
}

}  // namespace
}  // namespace pangaea
