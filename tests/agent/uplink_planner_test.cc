#include "agent/uplink/uplink_planner.h"

#include <gtest/gtest.h>

#include <map>

#include "common/map/consistency.h"
#include "common/map/digest.h"
#include "common/map/map_edit.h"
#include "common/map/trajectory.h"
#include "tests/agent/uplink_random_history.h"

namespace pangaea {
namespace {

constexpr SessionId kSession = RandomHistory::kSession;

// What the server makes of a plan: the octets travel, and every edit must be valid where it stands.
void Deliver(const UplinkPlan& plan, Atlas& server) {
  const auto edits = DecodeEdits(EncodeEdits(plan.edits));
  ASSERT_TRUE(edits);
  for (const MapEdit& edit : *edits) {
    const Status status = Apply(edit, server);
    ASSERT_TRUE(status) << status.error().message;
    ASSERT_TRUE(TouchesOnly(edit, kSession));
  }
}

void ApplyAll(std::span<const MapEdit> edits, Atlas& atlas) {
  for (const MapEdit& edit : edits) ASSERT_TRUE(Apply(edit, atlas));
}

std::vector<std::int64_t> Stamps(const Atlas& atlas) {
  std::vector<std::int64_t> stamps;
  for (const TrajectoryPose& pose : SessionTrajectory(atlas, kSession)) stamps.push_back(pose.stamp_ns);
  return stamps;
}

std::map<KeyframeId, double> Vergences(const Atlas& atlas) {
  std::map<KeyframeId, double> vergences;
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) { vergences[keyframe.id] = keyframe.data->vergence; });
  return vergences;
}

class UplinkPlannerHistory : public testing::TestWithParam<std::uint64_t> {};

TEST_P(UplinkPlannerHistory, AfterAFlushTheServersAtlasEqualsTheAgents) {
  RandomHistory agent(GetParam());
  std::mt19937_64 random(GetParam());
  UplinkPlanner planner({}, kSession);
  Atlas server;
  for (int step = 0; step < 1500; ++step) {
    agent.Step();
    if (random() % 20 != 0) continue;
    const std::vector<MapEdit> applied = agent.Take();
    Deliver(planner.Plan(agent.atlas(), applied, PlanKind::kOngoing), server);
    ASSERT_EQ(Digest(server), Digest(planner.mirror()));
  }
  ASSERT_GT(server.keyframe_count(), 0U);
  const UplinkPlan flush = planner.Plan(agent.atlas(), agent.Take(), PlanKind::kFlush);
  Deliver(flush, server);
  Deliver({planner.PlanClosing(agent.atlas()), {}}, server);
  Atlas own = agent.atlas();
  ApplyAll(flush.own_edits, own);
  EXPECT_EQ(Digest(server), Digest(own));
  EXPECT_EQ(Digest(planner.mirror()), Digest(own));
  EXPECT_EQ(CheckConsistency(server), std::vector<std::string>());
  EXPECT_EQ(Vergences(server), Vergences(own));
  EXPECT_EQ(Stamps(server), Stamps(own));
  for (const MapId map : own.Maps()) EXPECT_EQ(server.FindMap(map)->closed, own.FindMap(map)->closed);
  // What has just been flushed need not be sent again.
  EXPECT_TRUE(planner.Plan(own, flush.own_edits, PlanKind::kFlush).edits.empty());
}

INSTANTIATE_TEST_SUITE_P(Seeds, UplinkPlannerHistory, testing::Range<std::uint64_t>(1, 31));

// A line of keyframes, half a second apart, each below the one before and observing one landmark of its own.
class Line {
 public:
  void Add() {
    const std::uint32_t counter = ++count_;
    auto data = std::make_shared<KeyframeData>();
    data->stamp_ns = counter * 500'000'000LL;
    data->camera = {640, 480, 400.0, 400.0, 320.0, 240.0, 0.1};
    data->features.keypoints.resize(40);
    data->features.descriptors.resize(40);
    const KeyframeId parent = counter == 1 ? KeyframeId{} : KeyframeId{kSession, counter - 1};
    Do(AddKeyframe{{kSession, counter}, {kSession, 1}, parent, Rigid3d({1, 0, 0, 0}, {-0.1, 0, 0}), data});
    Do(AddLandmark{{kSession, counter}, {kSession, counter}, 0, {0.1, 0.2, 4.0}});
  }
  void Do(MapEdit edit) {
    ASSERT_TRUE(Apply(edit, atlas));
    edits.push_back(std::move(edit));
  }
  UplinkPlan Plan(UplinkPlanner& planner, PlanKind kind = PlanKind::kOngoing) {
    return planner.Plan(atlas, std::exchange(edits, {}), kind);
  }

  Atlas atlas;
  std::vector<MapEdit> edits;

 private:
  std::uint32_t count_ = 0;
};

template <typename Edit>
std::size_t CountOf(const UplinkPlan& plan) {
  return static_cast<std::size_t>(std::count_if(
      plan.edits.begin(), plan.edits.end(), [](const MapEdit& edit) { return std::holds_alternative<Edit>(edit); }));
}

TEST(UplinkPlanner, AKeyframeIsSentOnceWhenItLeftTheWindow) {
  Line line;
  UplinkPlanner planner({}, kSession);
  for (int i = 0; i < 3; ++i) line.Add();
  EXPECT_TRUE(line.Plan(planner).edits.empty());
  line.Add();
  const UplinkPlan plan = line.Plan(planner);
  EXPECT_EQ(CountOf<AddKeyframe>(plan), 1U);
  EXPECT_EQ(CountOf<AddLandmark>(plan), 1U);
  EXPECT_TRUE(line.Plan(planner).edits.empty());
}

TEST(UplinkPlanner, ALandmarkThatOneKeyframeAloneSeesIsSentWhenAnotherSeesItOrWithTheFlush) {
  Line line;
  UplinkPlanner planner({}, kSession);
  for (int i = 0; i < 6; ++i) line.Add();
  // Of the settled keyframes the first one begins the map.
  UplinkPlan plan = line.Plan(planner);
  EXPECT_EQ(CountOf<AddKeyframe>(plan), 3U);
  EXPECT_EQ(CountOf<AddLandmark>(plan), 1U);
  line.Do(AddObservation{{kSession, 2}, {kSession, 3}, 1});
  plan = line.Plan(planner);
  EXPECT_EQ(CountOf<AddLandmark>(plan), 1U);
  EXPECT_EQ(CountOf<AddObservation>(plan), 1U);
  line.Do(RemoveLandmark{{kSession, 3}});
  EXPECT_TRUE(line.Plan(planner).edits.empty());
  EXPECT_EQ(CountOf<AddLandmark>(line.Plan(planner, PlanKind::kFlush)), 3U);
}

TEST(UplinkPlanner, FramesOfAStandingCameraSettleTheLastKeyframeAfterFiveSeconds) {
  Line line;
  UplinkPlanner planner({}, kSession);
  line.Add();
  line.Do(AddFramePoses{{{{kSession, 1}, {5'400'000'000, Rigid3d()}}}});
  EXPECT_TRUE(line.Plan(planner).edits.empty());
  line.Do(AddFramePoses{{{{kSession, 1}, {5'500'000'000, Rigid3d()}}}});
  const UplinkPlan plan = line.Plan(planner);
  EXPECT_EQ(CountOf<AddKeyframe>(plan), 1U);
  ASSERT_EQ(CountOf<AddFramePoses>(plan), 1U);
}

TEST(UplinkPlanner, AKeyframeCulledBeforeItSettledIsNeverSentButItsFrameIs) {
  Line line;
  UplinkPlanner planner({}, kSession);
  line.Add();
  line.Add();
  line.Do(RemoveKeyframe{{kSession, 2}});
  const UplinkPlan plan = line.Plan(planner, PlanKind::kFlush);
  EXPECT_EQ(CountOf<AddKeyframe>(plan), 1U);
  EXPECT_EQ(CountOf<RemoveKeyframe>(plan), 0U);
  EXPECT_EQ(CountOf<AddFramePoses>(plan), 1U);
}

TEST(UplinkPlanner, FramesThatACulledGuestLeftBehindAreNotSent) {
  Line line;
  UplinkPlanner planner({}, kSession);
  line.Add();
  auto data = std::make_shared<KeyframeData>(*line.atlas.FindKeyframe({kSession, 1})->data);
  data->stamp_ns += 7;
  line.Do(AddKeyframe{{kSession + 1, 1}, {kSession, 1}, {kSession, 1}, Rigid3d(), data});
  line.Do(RemoveKeyframe{{kSession + 1, 1}});
  ASSERT_NE(line.atlas.FindKeyframe({kSession, 1})->frames, nullptr);
  EXPECT_EQ(CountOf<AddFramePoses>(line.Plan(planner, PlanKind::kFlush)), 0U);
}

TEST(UplinkPlanner, AFlushLetsGoALandmarkOfOthersThatTheServerHasNoMore) {
  Line line;
  UplinkPlanner planner({}, kSession);
  line.Add();
  line.Plan(planner, PlanKind::kFlush);
  const LandmarkId of_others{kSession + 1, 5};
  // The server has it no more: the mirror does not learn of it.
  line.Do(AddLandmark{of_others, {kSession, 1}, 1, {0.0, 0.0, 5.0}});
  const UplinkPlan plan = line.Plan(planner, PlanKind::kFlush);
  EXPECT_TRUE(plan.edits.empty());
  ASSERT_EQ(plan.own_edits.size(), 1U);
  ApplyAll(plan.own_edits, line.atlas);
  EXPECT_EQ(line.atlas.FindLandmark(of_others), nullptr);
  EXPECT_EQ(DigestOfSession(planner.mirror(), kSession), DigestOfSession(line.atlas, kSession));
}

TEST(UplinkPlanner, OfALandmarkOfOthersThatIsGoneHereTheSightingsAreTakenBack) {
  Line line;
  UplinkPlanner planner({}, kSession);
  line.Add();
  const LandmarkId of_others{kSession + 1, 5};
  line.Do(AddKeyframe{
      {kSession + 1, 1}, {kSession, 1}, {kSession, 1}, Rigid3d(), line.atlas.FindKeyframe({kSession, 1})->data});
  line.Do(AddLandmark{of_others, {kSession + 1, 1}, 1, {0.0, 0.0, 5.0}});
  line.Do(AddObservation{of_others, {kSession, 1}, 1});
  planner.AdoptMirror(line.atlas);
  line.Do(RemoveLandmark{of_others});
  EXPECT_EQ(CountOf<RemoveObservation>(line.Plan(planner, PlanKind::kFlush)), 1U);
  EXPECT_NE(planner.mirror().FindLandmark(of_others), nullptr);
  EXPECT_EQ(DigestOfSession(planner.mirror(), kSession), DigestOfSession(line.atlas, kSession));
}

TEST(UplinkPlanner, ARootCulledBeforeItsHeirWasSentPassesOn) {
  Line line;
  UplinkPlanner planner({}, kSession);
  for (int i = 0; i < 4; ++i) line.Add();
  EXPECT_EQ(CountOf<AddKeyframe>(line.Plan(planner)), 1U);
  line.Do(RemoveKeyframe{{kSession, 1}});
  line.Plan(planner, PlanKind::kFlush);
  EXPECT_EQ(Digest(planner.mirror()), Digest(line.atlas));
  EXPECT_EQ(planner.mirror().FindMap({kSession, 1})->root, (KeyframeId{kSession, 2}));
}

TEST(UplinkPlanner, AKeyframeCulledAfterItWasSentIsRemovedAndForwards) {
  Line line;
  UplinkPlanner planner({}, kSession);
  for (int i = 0; i < 5; ++i) line.Add();
  EXPECT_EQ(CountOf<AddKeyframe>(line.Plan(planner)), 2U);
  line.Do(RemoveKeyframe{{kSession, 2}});
  EXPECT_EQ(CountOf<RemoveKeyframe>(line.Plan(planner)), 1U);
  EXPECT_EQ(planner.mirror().Resolve(KeyframeId{kSession, 2}), (KeyframeId{kSession, 1}));
}

TEST(UplinkPlanner, ASentLandmarkThatIsFusedForwardsToItsAbsorberAtTheServer) {
  Line line;
  UplinkPlannerOptions options;
  options.min_observations = 1;
  UplinkPlanner planner(options, kSession);
  for (int i = 0; i < 5; ++i) line.Add();
  EXPECT_EQ(CountOf<AddLandmark>(line.Plan(planner)), 2U);
  line.Do(FuseLandmarks{{kSession, 1}, {kSession, 2}});
  EXPECT_EQ(CountOf<FuseLandmarks>(line.Plan(planner)), 1U);
  EXPECT_EQ(planner.mirror().Resolve(LandmarkId{kSession, 2}), (LandmarkId{kSession, 1}));
  // The absorber is still in the window: the fusion waits for it.
  line.Do(FuseLandmarks{{kSession, 5}, {kSession, 1}});
  EXPECT_TRUE(line.Plan(planner).edits.empty());
  line.Plan(planner, PlanKind::kFlush);
  EXPECT_EQ(planner.mirror().Resolve(LandmarkId{kSession, 2}), (LandmarkId{kSession, 5}));
}

TEST(UplinkPlanner, OnlyMovesBeyondTheThresholdsAreSentBeforeTheFlush) {
  Line line;
  UplinkPlanner planner({}, kSession);
  for (int i = 0; i < 4; ++i) line.Add();
  line.Plan(planner);
  line.Do(MoveKeyframes{{{{kSession, 1}, Rigid3d({1, 0, 0, 0}, {-0.1005, 0, 0})}}});
  line.Do(MoveLandmarks{{{{kSession, 1}, {0.1, 0.2, 4.005}}}});
  EXPECT_TRUE(line.Plan(planner).edits.empty());
  line.Do(MoveKeyframes{{{{kSession, 1}, Rigid3d({1, 0, 0, 0}, {-0.102, 0, 0})}}});
  line.Do(MoveLandmarks{{{{kSession, 1}, {0.1, 0.2, 4.02}}}});
  const UplinkPlan plan = line.Plan(planner);
  EXPECT_EQ(CountOf<MoveKeyframes>(plan), 1U);
  EXPECT_EQ(CountOf<MoveLandmarks>(plan), 1U);
}

TEST(UplinkPlanner, ClosingAMapSendsAllOfItFirst) {
  Line line;
  UplinkPlanner planner({}, kSession);
  for (int i = 0; i < 2; ++i) line.Add();
  line.Do(CloseMap{{kSession, 1}});
  const UplinkPlan plan = line.Plan(planner);
  EXPECT_EQ(CountOf<AddKeyframe>(plan), 2U);
  EXPECT_EQ(CountOf<CloseMap>(plan), 0U);
  const std::vector<MapEdit> closing = planner.PlanClosing(line.atlas);
  ASSERT_EQ(closing.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<CloseMap>(closing.front()));
  EXPECT_TRUE(planner.PlanClosing(line.atlas).empty());
}

TEST(UplinkPlanner, OnesMapThatBecamePartOfAnothersIsClosedOnceAtTheEnd) {
  constexpr SessionId kOther = 99;
  Line line;
  UplinkPlanner planner({}, kSession);
  line.Add();
  line.Plan(planner, PlanKind::kFlush);
  EXPECT_TRUE(planner.PlanFarewell().empty()) << "nobody absorbed it";
  Atlas merged = planner.mirror();
  AddKeyframe root;
  root.id = {kOther, 1};
  root.map = {kOther, 1};
  root.data = line.atlas.FindKeyframe({kSession, 1})->data;
  ASSERT_TRUE(Apply(root, merged));
  ASSERT_TRUE(Apply(MergeMaps{root.map, {kSession, 1}, {}, {kSession, 1}, root.id}, merged));
  planner.AdoptMirror(merged);
  const std::vector<MapEdit> farewell = planner.PlanFarewell();
  ASSERT_EQ(farewell.size(), 1U);
  EXPECT_EQ(std::get<CloseMap>(farewell.front()).map, (MapId{kSession, 1}));
  EXPECT_TRUE(Apply(farewell.front(), merged)) << "the server takes it";
  EXPECT_FALSE(merged.FindMap({kOther, 1})->closed) << "the other goes on";
  EXPECT_TRUE(planner.PlanFarewell().empty());
}

TEST(UplinkPlanner, NumbersOnABoundaryOfTheDigestsGridAreMovedOnBothSidesAlike) {
  Line line;
  UplinkPlanner planner({}, kSession);
  for (std::uint32_t i = 1; i <= 30; ++i) line.Add();
  std::mt19937_64 random(1);
  const auto boundary = [&] { return (static_cast<double>(random() % 10000) + 0.5) * 1e-4; };
  for (std::uint32_t i = 1; i <= 30; ++i) {
    line.Do(MoveKeyframes{{{{kSession, i}, Rigid3d(ExpSo3({0.01, 0.02, -0.01}), {-0.1, 0.02, 0.01})}}});
    const Keyframe& keyframe = *line.atlas.FindKeyframe({kSession, i});
    const Eigen::Vector3d point = keyframe.camera_from_map.Inverse().translation().array().round().matrix() +
                                  Eigen::Vector3d(boundary(), boundary(), 4.0 + boundary());
    line.Do(MoveLandmarks{{{{kSession, i}, keyframe.camera_from_map * point}}});
  }
  const UplinkPlan flush = line.Plan(planner, PlanKind::kFlush);
  EXPECT_FALSE(flush.own_edits.empty());
  Atlas own = line.atlas;
  ApplyAll(flush.own_edits, own);
  EXPECT_EQ(Digest(own), Digest(planner.mirror()));
}

TEST(UplinkPlanner, ALandmarkBehindItsReferenceCameraIsGivenUpOnBothSides) {
  Line line;
  UplinkPlanner planner({}, kSession);
  line.Add();
  // Turned half round, the landmark stays where it was: behind.
  line.Do(MoveKeyframes{{{{kSession, 1}, Rigid3d({0, 0, 1, 0}, {0, 0, 0})}}});
  const UplinkPlan flush = line.Plan(planner, PlanKind::kFlush);
  Atlas own = line.atlas;
  ApplyAll(flush.own_edits, own);
  EXPECT_EQ(own.landmark_count(), 0U);
  EXPECT_EQ(Digest(own), Digest(planner.mirror()));
}

TEST(UplinkPlanner, AfterARejectionWhatTheServerMissesIsSentAnew) {
  Line line;
  UplinkPlanner planner({}, kSession);
  Atlas server;
  for (int i = 0; i < 6; ++i) line.Add();
  Deliver(line.Plan(planner), server);
  const Atlas confirmed = server;
  line.Add();
  line.Plan(planner);  // rejected
  planner.AdoptMirror(confirmed);
  Deliver(line.Plan(planner), server);
  EXPECT_EQ(server.keyframe_count(), 4U);
  EXPECT_EQ(Digest(server), Digest(planner.mirror()));
}

}  // namespace
}  // namespace pangaea
