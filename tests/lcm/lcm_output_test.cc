#include "common/lcm/lcm_output.h"

#include <gtest/gtest.h>

#include <pangaea_lcm/pose_t.hpp>
#include <pangaea_lcm/statistics_t.hpp>
#include <pangaea_lcm/tracking_state_t.hpp>

#include "common/lcm/message_codec.h"
#include "common/lcm/pose_codec.h"
#include "common/lcm/receiver.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

AgentState SomeState() {
  AgentState state;
  state.session = 0xFEDCBA9876543210;
  state.stamp_ns = 1'403'715'273'262'142'976;
  state.tracking = AgentTracking::kTracking;
  state.discontinuity = true;
  state.map_counter = 3;
  state.odom_from_body = Rigid3d::Exp((Vector6d() << 1, 2, 3, 0.1, 0.2, 0.3).finished());
  state.map_from_odom = Similarity3d(1.5, Eigen::Quaterniond::Identity(), {4, 5, 6});
  state.frames = 100;
  state.tracked = 99;
  state.dropped = 1;
  state.keyframes = 12;
  state.landmarks = 3456;
  state.tracking_ms = 6.5F;
  return state;
}

TEST(LcmOutput, AStateIsToldOnThreeChannels) {
  testing::TemporaryFolder folder;
  const std::string url = "file://" + (folder.path() / "out.lcm").string();
  const LcmChannels channels;
  {
    auto output = LcmOutput::Open(url, channels);
    ASSERT_TRUE(output) << output.error().message;
    AgentState state = SomeState();
    EXPECT_TRUE(output->Publish(state));
    state.tracking = AgentTracking::kLost;
    EXPECT_TRUE(output->Publish(state));
    EXPECT_TRUE(output->Close());
  }
  auto receiver = LcmReceiver::Open(*LcmUrl::Parse(url), {channels.pose, channels.tracking_state, channels.statistics});
  ASSERT_TRUE(receiver);
  std::vector<std::string> order;
  while (const auto message = (*receiver)->Next({})) {
    ASSERT_TRUE(*message);
    order.push_back((*message)->channel);
    const LcmPayload& payload = (*message)->payload;
    if ((*message)->channel == channels.pose) {
      const auto pose = DecodeMessage<pangaea_lcm::pose_t>(payload);
      ASSERT_TRUE(pose);
      EXPECT_EQ(static_cast<std::uint64_t>(pose->session), 0xFEDCBA9876543210);
      EXPECT_EQ(pose->stamp_ns, 1'403'715'273'262'142'976);
      EXPECT_EQ(pose->map_counter, 3);
      EXPECT_TRUE(pose->discontinuity);
      EXPECT_EQ(RigidOf(pose->odom_from_body)->translation(), SomeState().odom_from_body.translation());
      EXPECT_EQ(RigidOf(pose->map_from_odom)->translation(), Eigen::Vector3d(4, 5, 6));
      EXPECT_EQ(pose->map_from_odom_scale, 1.5);
    } else if ((*message)->channel == channels.statistics) {
      const auto statistics = DecodeMessage<pangaea_lcm::statistics_t>(payload);
      ASSERT_TRUE(statistics);
      EXPECT_EQ(statistics->frames, 100);
      EXPECT_EQ(statistics->landmarks, 3456);
      EXPECT_EQ(statistics->tracking_ms, 6.5);
    } else {
      const auto state = DecodeMessage<pangaea_lcm::tracking_state_t>(payload);
      ASSERT_TRUE(state);
      EXPECT_EQ(state->state, order.size() < 4 ? int{pangaea_lcm::tracking_state_t::TRACKING}
                                               : int{pangaea_lcm::tracking_state_t::LOST});
    }
  }
  EXPECT_EQ(order, (std::vector<std::string>{channels.pose, channels.tracking_state, channels.statistics,
                                             channels.tracking_state, channels.statistics}))
      << "no pose while lost";
}

TEST(LcmOutput, AWrongAddressIsAnError) {
  EXPECT_FALSE(LcmOutput::Open("nonsense", {}));
  LcmChannels channels;
  channels.pose.clear();
  EXPECT_FALSE(LcmOutput::Open("file:///tmp/unused.lcm", channels));
}

}  // namespace
}  // namespace pangaea
