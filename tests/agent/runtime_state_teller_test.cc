#include <gtest/gtest.h>

#include <vector>

#include "agent/runtime/state_teller.h"

namespace pangaea {
namespace {

using std::chrono_literals::operator""ms;

constexpr SessionId kSession = 7;

// Remembers what it is told.
class ListeningUplink final : public UplinkThread {
 public:
  bool Submit(UplinkBatch) override { return true; }
  Result<std::vector<MapEdit>> Flush(UplinkBatch, std::chrono::milliseconds) override { return std::vector<MapEdit>{}; }
  std::optional<ReadyCorrection> TakeCorrection() override { return std::nullopt; }
  std::vector<KeyframeId> TakeForgettable() override { return {}; }
  bool AwaitCorrection(std::chrono::milliseconds) override { return false; }
  void AskWhere(std::uint64_t, std::shared_ptr<const KeyframeData>) override {}
  std::optional<RelocalizationAnswer> TakeAnswer() override { return std::nullopt; }
  void Tell(const AgentState& state) override { told.push_back(state); }
  void Hurry() override {}
  void Stop() override {}
  UplinkCounters counters() const override { return present; }

  UplinkCounters present;
  std::vector<AgentState> told;
};

class StateTellerTest : public ::testing::Test {
 protected:
  void Tell(const TrackingResult& result) {
    ++(result.tracked ? record_.tracked : record_.lost);
    teller_.TellFrame(static_cast<std::int64_t>(record_.frames()), result, Atlas(), record_, 3, 5ms);
  }

  ListeningUplink uplink_;
  FlightRecord record_;
  StateTeller teller_{kSession, Rigid3d(), &uplink_, nullptr};
};

TrackingResult Tracked(double x, std::optional<Rigid3d> current_from_previous) {
  TrackingResult result;
  result.state = TrackingState::kTracking;
  result.tracked = true;
  result.map = {kSession, 2};
  result.camera_from_map = Rigid3d({1, 0, 0, 0}, {-x, 0, 0});
  result.current_from_previous = current_from_previous;
  return result;
}

TEST_F(StateTellerTest, EachFrameIsToldWithWhatIsKnownOfTheFlightAndTheUplink) {
  uplink_.present.bytes_sent = 1000;
  uplink_.present.last_sequence = 9;
  uplink_.present.acknowledged = 7;
  Tell(Tracked(1.0, std::nullopt));
  ASSERT_EQ(uplink_.told.size(), 1U);
  const AgentState& state = uplink_.told[0];
  EXPECT_EQ(state.session, kSession);
  EXPECT_EQ(state.stamp_ns, 1);
  EXPECT_EQ(state.tracking, AgentTracking::kTracking);
  EXPECT_EQ(state.map_counter, 2U);
  EXPECT_EQ(state.frames, 1U);
  EXPECT_EQ(state.tracked, 1U);
  EXPECT_EQ(state.dropped, 3U);
  EXPECT_FLOAT_EQ(state.tracking_ms, 5.0F);
  EXPECT_EQ(state.bytes_sent, 1000U);
  EXPECT_EQ(state.retained_edits, 2U);
}

TEST_F(StateTellerTest, ALostFrameKeepsThePlaceOfTheLatestTrackedOneAndIsNoDiscontinuity) {
  const Rigid3d step({1, 0, 0, 0}, {-0.5, 0, 0});
  Tell(Tracked(1.0, std::nullopt));
  Tell(Tracked(7.0, std::nullopt));  // where the motion is not known
  TrackingResult lost;
  lost.state = TrackingState::kLost;
  Tell(lost);
  Tell(Tracked(7.5, step));
  ASSERT_EQ(uplink_.told.size(), 4U);
  EXPECT_TRUE(uplink_.told[1].discontinuity);
  EXPECT_EQ(uplink_.told[2].tracking, AgentTracking::kLost);
  EXPECT_FALSE(uplink_.told[2].discontinuity);
  EXPECT_EQ(uplink_.told[2].odom_from_body.translation(), uplink_.told[1].odom_from_body.translation());
  EXPECT_FALSE(uplink_.told[3].discontinuity);
  EXPECT_NEAR(uplink_.told[3].odom_from_body.translation().x(), 1.5, 1e-12);
}

TEST_F(StateTellerTest, TheOdometryKeepsItsLengthsWhereTheMapWasScaled) {
  TrackingResult first = Tracked(0.0, std::nullopt);
  TrackingResult second = Tracked(1.0, Rigid3d({1, 0, 0, 0}, {-1, 0, 0}));
  first.map_scale = second.map_scale = 2.0;
  Tell(first);
  Tell(second);
  ASSERT_EQ(uplink_.told.size(), 2U);
  EXPECT_NEAR(uplink_.told[1].odom_from_body.translation().x(), 0.5, 1e-12);
  EXPECT_EQ(uplink_.told[1].map_from_odom.scale(), 2.0);
}

TEST_F(StateTellerTest, BeforeTheFirstMapTheAgentInitializes) {
  Tell(TrackingResult{});
  ASSERT_EQ(uplink_.told.size(), 1U);
  EXPECT_EQ(uplink_.told[0].tracking, AgentTracking::kInitializing);
}

TEST_F(StateTellerTest, TheEndIsTheLatestStateFinished) {
  Tell(Tracked(1.0, std::nullopt));
  teller_.TellEnd();
  ASSERT_EQ(uplink_.told.size(), 2U);
  EXPECT_EQ(uplink_.told[1].tracking, AgentTracking::kFinished);
  EXPECT_EQ(uplink_.told[1].frames, 1U);
  EXPECT_EQ(uplink_.told[1].odom_from_body.translation(), uplink_.told[0].odom_from_body.translation());
}

}  // namespace
}  // namespace pangaea
