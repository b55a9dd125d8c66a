#include "server/runtime/downlink_thread.h"

#include <gtest/gtest.h>

#include <chrono>

#include "common/base/bounded_queue.h"
#include "tests/map/small_world.h"
#include "tests/server/service_harness.h"

namespace pangaea {
namespace {

MapInterest Interest(SessionId session) { return {session, 0, M(1, session), K(1, session), {}}; }

// After a restart of the server it may hear what an agent is interested in before it hears of the agent. While the
// camera rests, it is not told again.
TEST(DownlinkThread, AnInterestThatComesBeforeItsSessionIsRemembered) {
  const TemporaryStore place;
  ServiceHarness harness(place.path());
  Flight anna(kAnna);
  harness.Send(anna.Next());
  harness.WaitForAck(kAnna, 1);
  const auto make = [](ServerDraft& draft) {
    const Rigid3d beside = MakePose(0.05, 0.5, 0.0, 0.01);
    const std::vector<MapEdit> edits = {AddKeyframe{K(1, kBert), M(1, kBert), {}, MakePose(0.3, 1, 2, 3), MakeData(20)},
                                        AddKeyframe{K(2, kBert), M(1, kBert), K(1, kBert), beside, MakeData(20, 1)},
                                        MoveKeyframes{{{K(2, kBert), beside}}, 1},
                                        MoveKeyframes{{{K(1), MakePose(0.1, 0, 0, 0)}}, 1}};
    for (const MapEdit& edit : edits) {
      if (auto status = draft.Try(edit); !status) return status;
    }
    return Status();
  };
  const auto answer = harness.service->ProposeAndWait({{"test"}, make});
  ASSERT_TRUE(answer) << answer.error().message;

  BoundedQueue<SessionId> told(100);
  DownlinkThread downlink(
      *harness.service, {.wanted = 0},
      {[&told](const CorrectionPart& part) { (void)told.Push(part.session); }, [](std::uint64_t) { return false; }});
  downlink.Start();
  const auto next_told = [&told] { return told.PopUntil(std::chrono::steady_clock::now() + std::chrono::seconds(30)); };
  downlink.Take(Interest(kBert));
  downlink.Take(Interest(kAnna));
  EXPECT_EQ(next_told(), kAnna) << "Bert is not there yet";
  SessionAnnouncement announcement;
  announcement.session = kBert;
  announcement.name = "bert";
  announcement.site = "hall";
  harness.service->Submit(SessionAnnounced{announcement, {2, 200}});
  harness.WaitForEvent(AtlasEventKind::kSessionJoined);
  downlink.Notify();
  EXPECT_EQ(next_told(), kBert);
  downlink.Stop();
}

}  // namespace
}  // namespace pangaea
