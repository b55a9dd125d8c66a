// The threads that work on the atlas by themselves, with a service and a store, without a network.
#include "server/runtime/atlas_work.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/base/bounded_queue.h"
#include "common/map/consistency.h"
#include "common/map/spanning_tree.h"
#include "server/storage/undo.h"
#include "tests/map/small_world.h"
#include "tests/server/fusion_world.h"
#include "tests/server/service_harness.h"

namespace pangaea {
namespace {

using testing::kNewer;
using testing::kOlder;

// The edits that make all maps of an atlas anew.
std::vector<MapEdit> EditsThatMake(const Atlas& atlas) {
  std::vector<MapEdit> edits;
  for (const MapId map : atlas.Maps()) {
    for (const KeyframeId id : ParentsFirst(atlas, map)) {
      const Keyframe& keyframe = *atlas.FindKeyframe(id);
      const Keyframe* parent = atlas.FindKeyframe(keyframe.parent);
      const Rigid3d camera_from_parent =
          parent == nullptr ? keyframe.camera_from_map : keyframe.camera_from_map * parent->camera_from_map.Inverse();
      edits.push_back(AddKeyframe{id, map, keyframe.parent, camera_from_parent, keyframe.data});
    }
  }
  atlas.ForEachLandmark([&](const Landmark& landmark) {
    const Keyframe& reference = *atlas.FindKeyframe(landmark.reference);
    const auto at = std::ranges::find(landmark.observations, landmark.reference, &Observation::keyframe);
    edits.push_back(
        AddLandmark{landmark.id, reference.id, at->keypoint, reference.camera_from_map * landmark.point_in_map});
    for (const Observation& observation : landmark.observations) {
      if (observation.keyframe == landmark.reference) continue;
      edits.push_back(AddObservation{landmark.id, observation.keyframe, observation.keypoint});
    }
  });
  return edits;
}

// As agents would have sent them.
void Fill(AtlasService& service, const Atlas& atlas) {
  const auto make = [&atlas](ServerDraft& draft) {
    for (const MapEdit& edit : EditsThatMake(atlas)) {
      if (auto status = draft.Try(edit); !status) return status;
    }
    return Status();
  };
  const auto answer = service.ProposeAndWait({{"test"}, make});
  ASSERT_TRUE(answer) << answer.error().message;
}

// Two maps of one room.
void Fill(AtlasService& service) { Fill(service, testing::TwoMaps(1).atlas); }

// A server without a network, until it is destroyed.
class WorkingServer {
 public:
  explicit WorkingServer(const std::filesystem::path& store, const WorkOptions& options = {})
      : harness_(store, {}, [this] { Changed(); }) {
    auto created = AtlasWork::Create(service(), options,
                                     {[this](const AtlasEvent& event) { harness_.OnEvent(event); }, [] {},
                                      [this](const RelocalizationAnswer& answer) { (void)answers_.Push(answer); }});
    EXPECT_TRUE(created) << created.error().message;
    work_ = std::move(*created);
    work_->Start();
    started_.store(true);
    work_->Notify();
  }
  ~WorkingServer() { work_->Stop(); }

  AtlasService& service() { return *harness_.service; }
  ServiceHarness& harness() { return harness_; }
  AtlasWork& work() { return *work_; }
  // A frame that one of the keyframes shows, without its depth, asked about by `sender`.
  void Ask(SessionId session, std::uint64_t request, KeyframeId shown, const Sender& sender) {
    auto frame = std::make_shared<KeyframeData>(*Map().FindKeyframe(shown)->data);
    for (Keypoint& keypoint : frame->features.keypoints) keypoint.u_right = -1.0F;
    work_->Ask({{session, request, std::move(frame)}, sender});
  }
  RelocalizationAnswer NextAnswer() { return answers_.Pop().value(); }
  const Atlas Map() { return service().State()->ingest.atlas; }

 private:
  void Changed() {
    if (started_.load()) work_->Notify();
  }

  std::atomic<bool> started_ = false;
  BoundedQueue<RelocalizationAnswer> answers_{10};
  std::unique_ptr<AtlasWork> work_;
  ServiceHarness harness_;
};

Atlas Stored(const std::filesystem::path& path) {
  auto store = Store::OpenReadOnly(path);
  EXPECT_TRUE(store);
  auto recovered = RecoverAtlas(*store);
  EXPECT_TRUE(recovered) << recovered.error().message;
  return recovered ? recovered->atlas : Atlas();
}

TEST(AtlasWork, TwoMapsOfOnePlaceBecomeOneAndWhatIsShownIsDurable) {
  const TemporaryStore place;
  WorkingServer server(place.path());
  Fill(server.service());
  server.harness().WaitForEvent(AtlasEventKind::kMerge);
  EXPECT_EQ(server.Map().Maps().size(), 1u);
  server.work().Stop();
  const Atlas atlas = server.Map();
  EXPECT_TRUE(CheckConsistency(atlas).empty());
  EXPECT_EQ(Fingerprint(Stored(place.path())), Fingerprint(atlas));
  const WorkReport report = server.work().report();
  EXPECT_EQ(report.merges, 1u);
  EXPECT_EQ(report.welds.front().sessions.size(), 2u);
  EXPECT_FALSE(report.welds.front().text.empty());
}

// No keyframe finds enough that looks as before.
TEST(AtlasWork, TwoMapsOfARoomThatWasRearrangedBecomeOneWhenNobodyWorksOnThem) {
  testing::SurveyedWorld world(9);
  world.Fly(kOlder, testing::CirclePoses(0, 39, 40), {});
  world.Rearrange(0.05);
  world.Fly(kNewer, testing::CirclePoses(3, 42, 40), {.map_from_world = Similarity3d(MakePose(0.7, 3.0, -2.0, 1.0))});
  const TemporaryStore place;
  WorkingServer server(place.path());
  Fill(server.service(), world.atlas);
  server.harness().WaitForEvent(AtlasEventKind::kMerge);
  server.work().Stop();
  EXPECT_EQ(server.Map().Maps().size(), 1u);
  EXPECT_TRUE(CheckConsistency(server.Map()).empty());
  const WorkReport report = server.work().report();
  EXPECT_NE(report.welds.front().text.find("maps compared"), std::string::npos) << report.welds.front().text;
}

TEST(AtlasWork, ALostAgentIsToldWhereInTheAtlasItsFrameWasTakenAndAForeignQuestionIsRefused) {
  constexpr SessionId kLost = 77;
  constexpr Sender kAgent{5, 500};
  const TemporaryStore place;
  WorkingServer server(place.path());
  Fill(server.service());
  server.harness().WaitForEvent(AtlasEventKind::kMerge);
  KeyframeId shown;
  server.Map().ForEachKeyframe(kOlder, [&](const Keyframe& keyframe) { shown = keyframe.id; });
  SessionAnnouncement announcement;
  announcement.session = kLost;
  announcement.name = "lost";
  announcement.site = "hall";
  announcement.ideal_camera = server.Map().FindKeyframe(shown)->data->camera;
  server.service().Submit(SessionAnnounced{announcement, kAgent});
  server.harness().WaitForEvent(AtlasEventKind::kSessionJoined);

  server.Ask(kLost, 3, shown, {6, 600});
  server.harness().WaitForEvent(AtlasEventKind::kRejected);
  server.Ask(kLost, 3, shown, kAgent);
  server.harness().WaitForEvent(AtlasEventKind::kRelocalized);
  const RelocalizationAnswer answer = server.NextAnswer();
  EXPECT_EQ(answer.request, 3u);
  ASSERT_TRUE(answer.found);
  const Atlas atlas = server.Map();
  const Rigid3d camera_from_map =
      answer.camera_from_reference * atlas.FindKeyframe(atlas.Resolve(answer.reference))->camera_from_map;
  const Rigid3d& expected = atlas.FindKeyframe(shown)->camera_from_map;
  EXPECT_LT((camera_from_map.Inverse().translation() - expected.Inverse().translation()).norm(), 0.05);
}

TEST(AtlasWork, AMergeThatWasUndoneIsNotMadeAgain) {
  const TemporaryStore place;
  std::string cause;
  {
    WorkingServer server(place.path());
    Fill(server.service());
    server.harness().WaitForEvent(AtlasEventKind::kMerge);
    server.work().Stop();
    cause = server.work().report().welds.front().cause;
  }
  {
    Store store = Store::Open(place.path(), "hall", {}).value();
    const auto undone = UndoCause(store, cause, 1);
    ASSERT_TRUE(undone) << undone.error().message;
  }
  EXPECT_EQ(Stored(place.path()).Maps().size(), 2u);
  WorkingServer server(place.path());
  // Every keyframe is looked up anew after a restart; until all were, the merge would have been found again.
  while (server.work().report().recognition_ms.count() < server.Map().keyframe_count()) std::this_thread::yield();
  server.work().Stop();
  EXPECT_GT(server.work().report().recognized, 0u);
  EXPECT_EQ(server.Map().Maps().size(), 2u);
}

// An optimizer that says when it begins, and takes until it is stopped, or ends at once from the third time on.
class FakeOptimizer {
 public:
  std::optional<OptimizedMap> operator()(const std::stop_token& stop) {
    MutexLock lock(mutex_);
    ++begun_;
    changed_.notify_all();
    if (begun_ >= 3) return std::nullopt;
    changed_.wait(mutex_, stop, [] { return false; });
    return std::nullopt;
  }
  void WaitForBegin(int times) {
    MutexLock lock(mutex_);
    changed_.wait(mutex_, [&]() REQUIRES(mutex_) { return begun_ >= times; });
  }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  int begun_ GUARDED_BY(mutex_) = 0;
};

// One that says how much of the map it was told has been seen, and that it has seen one landmark more each time. The
// second time it takes until it is stopped.
class FakeLooker {
 public:
  std::optional<OptimizedMap> operator()(const LookedAtMap& before, const std::stop_token& stop) {
    MutexLock lock(mutex_);
    told_.push_back(before.landmarks.size());
    changed_.notify_all();
    const std::size_t times = told_.size();
    if (times == 2) changed_.wait(mutex_, stop, [] { return false; });
    OptimizedMap result;
    result.removals.push_back(RemoveLandmark{L(1)});
    result.looked_at.emplace().landmarks.resize(times);
    return result;
  }
  std::vector<std::size_t> WaitForBegin(std::size_t times) {
    MutexLock lock(mutex_);
    changed_.wait(mutex_, [&]() REQUIRES(mutex_) { return told_.size() >= times; });
    return told_;
  }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  std::vector<std::size_t> told_ GUARDED_BY(mutex_);
};

std::vector<MapEdit> KeepAll(const IngestState&, const std::stop_token&) { return {}; }

std::optional<OptimizedMap> OptimizeNothing(const Atlas&, MapId, const LookedAtMap&, const std::stop_token&) {
  return std::nullopt;
}

// The thread at a server that has something of Anna's.
class OptimizationThreadTest : public ::testing::Test {
 protected:
  OptimizationThreadTest() {
    Flight flight(kAnna);
    for (int i = 0; i < 2; ++i) harness_.Send(flight.Next());
    harness_.WaitForAck(kAnna, 2);
  }

  OptimizationThread& Start(OptimizationThread::Optimizer optimize, OptimizationThread::Tidier tidy) {
    thread_.emplace(
        *harness_.service, OptimizationThread::Jobs{std::move(optimize), std::move(tidy), {}, {}},
        OptimizationAgendaOptions{}, [] {}, ledger_);
    thread_->Start();
    return *thread_;
  }
  OptimizationThread& Start(FakeOptimizer& optimizer) {
    return Start([&](const Atlas&, MapId, const LookedAtMap&, const std::stop_token& stop) { return optimizer(stop); },
                 KeepAll);
  }

  const TemporaryStore place_;
  ServiceHarness harness_{place_.path()};
  WorkLedger ledger_;

 private:
  std::optional<OptimizationThread> thread_;
};

TEST(WorkReportTest, SomethingIsUnderWayUntilAVersionAndASessionsEndWereLookedAt) {
  WorkReport report;
  report.looked_up_version = report.planned_version = 7;
  report.planned_living = report.looked_up_living = 2;
  EXPECT_FALSE(report.IsUnderWay(7, 2));
  EXPECT_TRUE(report.IsUnderWay(8, 2));
  EXPECT_TRUE(report.IsUnderWay(7, 1)) << "what the session that ended worked on may be made smaller";
  EXPECT_FALSE(report.IsUnderWay(7)) << "which no agent that still runs waits for";
  report.economizing = true;
  EXPECT_TRUE(report.IsUnderWay(7));
}

TEST_F(OptimizationThreadTest, WhatIsRedundantIsCulledOnceAsTheServersOwnEdit) {
  OptimizationThread& thread = Start(OptimizeNothing, [](const IngestState&, const std::stop_token&) {
    return std::vector<MapEdit>{RemoveLandmark{L(1)}, RemoveKeyframe{K(4711)}};
  });
  thread.Notify();
  harness_.WaitForEvent(AtlasEventKind::kCulled);
  thread.Stop();
  EXPECT_EQ(harness_.service->State()->ingest.atlas.FindLandmark(L(1)), nullptr);
  EXPECT_EQ(ledger_.Read().culled, 1u) << "what was not there is left out";
}

TEST_F(OptimizationThreadTest, WeldsCancelTheRunningOneWhichIsLaunchedAgain) {
  FakeOptimizer optimizer;
  OptimizationThread& thread = Start(optimizer);
  thread.Welded(M(1), {});
  optimizer.WaitForBegin(1);
  thread.Welded(M(1), {});
  optimizer.WaitForBegin(2);
  thread.Welded(M(1), {});
  optimizer.WaitForBegin(3);
  // Before the end, which cancels the third.
  EXPECT_EQ(ledger_.Read().cancelled_optimizations, 2u);
  thread.Stop();
}

TEST_F(OptimizationThreadTest, WhatALookSawIsKnownToTheNextOneWhereItsResultWasTaken) {
  FakeLooker looker;
  OptimizationThread& thread = Start(
      [&](const Atlas&, MapId, const LookedAtMap& before, const std::stop_token& stop) { return looker(before, stop); },
      KeepAll);
  thread.Welded(M(1), {});
  while (ledger_.Read().global_ms.count() < 1) std::this_thread::yield();
  thread.Welded(M(1), {});
  looker.WaitForBegin(2);
  thread.Welded(M(1), {});
  EXPECT_EQ(looker.WaitForBegin(3), (std::vector<std::size_t>{0, 1, 1})) << "the second one was cancelled";
  thread.Stop();
}

TEST_F(OptimizationThreadTest, StoppingGivesUpWhatRuns) {
  FakeOptimizer optimizer;
  OptimizationThread& thread = Start(optimizer);
  thread.Welded(M(1), {});
  optimizer.WaitForBegin(1);
  thread.Stop();
  EXPECT_EQ(ledger_.Read().global_ms.count(), 0u);
}

}  // namespace
}  // namespace pangaea
