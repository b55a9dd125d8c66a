#include <gtest/gtest.h>

#include "agent/runtime/flight_record.h"
#include "tests/agent/captured_log.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr SessionId kSession = kAnna;
constexpr std::int64_t kStart = 1403715273 * kSecond;

TrackingResult Tracked(double x = 0.0) {
  TrackingResult result;
  result.state = TrackingState::kTracking;
  result.tracked = true;
  result.camera_from_map = Rigid3d({1, 0, 0, 0}, {x, 0, 0});
  return result;
}

TrackingResult Untracked(TrackingState state) {
  TrackingResult result;
  result.state = state;
  return result;
}

FlightRecorder Recorder(const Rigid3d& camera_from_body = {}) { return {kSession, "a1", std::nullopt, camera_from_body}; }

TEST(FlightRecorder, TheLiveTrajectoryIsTheBodysAndHasTheTrackedFramesAlone) {
  FlightRecorder recorder = Recorder(Rigid3d({1, 0, 0, 0}, {0, 0.5, 0}));
  recorder.Take(kStart, Tracked(1.0), Atlas{});
  recorder.Take(kStart + 1, Untracked(TrackingState::kLost), Atlas{});
  const FlightRecord& record = recorder.record();
  EXPECT_EQ(record.tracked, 1U);
  EXPECT_EQ(record.lost, 1U);
  ASSERT_EQ(record.live_trajectory.size(), 1U);
  EXPECT_EQ(record.live_trajectory[0].stamp_ns, kStart);
  EXPECT_LT((record.live_trajectory[0].world_from_body.translation() - Eigen::Vector3d(-1.0, 0.5, 0.0)).norm(), 1e-12);
}

TEST(FlightRecorder, FramesThatGetTheirPoseLaterCountAsTrackedThen) {
  FlightRecorder recorder = Recorder();
  for (int i = 0; i < 3; ++i) recorder.Take(kStart + i, Untracked(TrackingState::kStarting), Atlas{});
  EXPECT_EQ(recorder.record().lost, 3U);
  TrackingResult beginning = Tracked();
  beginning.earlier_frames.resize(2);
  recorder.Take(kStart + 3, beginning, Atlas{});
  EXPECT_EQ(recorder.record().tracked, 3U);
  EXPECT_EQ(recorder.record().lost, 1U);
  EXPECT_EQ(recorder.record().frames(), 4U);
}

TEST(FlightRecorder, MemoryIsSampledEveryHalfMinuteOfTheFlight) {
  FlightRecorder recorder = Recorder();
  for (int second = 0; second <= 70; second += 10) recorder.Take(kStart + second * kSecond, Tracked(), Atlas{});
  const auto& memory = recorder.record().memory;
  ASSERT_EQ(memory.size(), 3U);
  for (std::size_t i = 0; i < memory.size(); ++i) {
    EXPECT_DOUBLE_EQ(memory[i].seconds, 30.0 * static_cast<double>(i));
    EXPECT_GT(memory[i].resident_mib, 1.0);
  }
}

TEST(FlightRecorder, ATurnedCameraIsSaidOnce) {
  CapturedLog log;
  FlightRecorder recorder = Recorder();
  SmallWorld world = RowOfThree();
  TrackingResult tracked = Tracked();
  tracked.reference = K(2);
  recorder.Take(kStart, tracked, world.atlas);
  EXPECT_EQ(log.waiting(), 0U);
  world.Do(SetVergence{kAnna, 0.01});
  for (int i = 1; i < 4; ++i) recorder.Take(kStart + i, tracked, world.atlas);
  ASSERT_EQ(log.waiting(), 1U);
  EXPECT_NE(log.Next().find("turned by 0.573 degrees"), std::string::npos);
}

TEST(FlightRecorder, EachLossIsSaidOnce) {
  const CapturedLog log;
  FlightRecorder recorder = Recorder();
  for (int loss = 0; loss < 2; ++loss) {
    recorder.Take(kStart, Tracked(), Atlas{});
    recorder.Take(kStart, Untracked(TrackingState::kLost), Atlas{});
    recorder.Take(kStart, Untracked(TrackingState::kLost), Atlas{});
  }
  EXPECT_EQ(log.waiting(), 2U);
}

}  // namespace
}  // namespace pangaea
