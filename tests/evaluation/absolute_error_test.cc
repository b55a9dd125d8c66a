#include "common/evaluation/absolute_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "common/evaluation/evaluation_report.h"

namespace pangaea {
namespace {

constexpr std::int64_t kStart = 1'400'000'000'000'000'000;
constexpr std::int64_t kSecond = 1'000'000'000;

// A flight in a curve, `seconds` after its start.
Rigid3d PoseAt(double seconds, double phase = 0.0) {
  const Eigen::Vector3d position(3.0 * std::cos(seconds + phase), 2.0 * std::sin(seconds), std::sin(2.0 * seconds));
  return Rigid3d(ExpSo3({0.2 * seconds, 0.3 * std::sin(seconds), 0.1}), position);
}

std::vector<StampedPose> Flight(double rate, double phase = 0.0) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < static_cast<int>(8.0 * rate); ++i) {
    const double seconds = i / rate;
    poses.push_back({kStart + std::llround(seconds * 1e9), PoseAt(seconds, phase)});
  }
  return poses;
}

const Similarity3d kMapFromWorld(1.0, Eigen::Quaterniond(0.8, 0.1, -0.5, 0.3), {4.0, -2.0, 7.0});

// What a perfect estimator says in a map of its own, lengths multiplied by `scale`.
std::vector<StampedPose> InMap(std::vector<StampedPose> poses, double scale = 1.0) {
  for (StampedPose& pose : poses) {
    const Eigen::Vector3d position = scale * (kMapFromWorld * pose.world_from_body.translation());
    pose.world_from_body = Rigid3d(kMapFromWorld.rotation() * pose.world_from_body.rotation(), position);
  }
  return poses;
}

AbsoluteError Evaluate(const std::vector<EvaluatedTrajectory>& sessions, const AbsoluteErrorOptions& options = {}) {
  const auto result = EvaluateAbsoluteError(sessions, options);
  EXPECT_TRUE(result) << result.error().message;
  return result.value_or(AbsoluteError{});
}

TEST(AbsoluteError, AnEstimateInAnotherFrameHasNoErrorAfterAlignment) {
  const AbsoluteError result = Evaluate({{.name = "a",
                                          .estimate = InMap(Flight(20.0)),
                                          .truth = Flight(200.0),
                                          .body_from_evaluated = {},
                                          .dataset_frames = 200}});
  EXPECT_EQ(result.error.count, 160U);
  EXPECT_LT(result.error.rms, 1e-9);
  EXPECT_LT(result.error.rotation_rms, 1e-5);
  EXPECT_EQ(result.truth_from_estimate.scale(), 1.0);
  EXPECT_NEAR(result.coverage, 0.8, 1e-12);
}

TEST(AbsoluteError, NoiseOfKnownSizeIsFound) {
  std::vector<StampedPose> estimate = InMap(Flight(20.0));
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 0.01);
  for (StampedPose& pose : estimate) {
    const Eigen::Vector3d error{noise(random), noise(random), noise(random)};  // braces draw in order
    pose.world_from_body = Rigid3d(pose.world_from_body.rotation(), pose.world_from_body.translation() + error);
  }
  const AbsoluteError result =
      Evaluate({{.name = "a", .estimate = estimate, .truth = Flight(200.0), .body_from_evaluated = {}}});
  EXPECT_NEAR(result.error.rms, 0.01 * std::sqrt(3.0), 0.002);
  EXPECT_LT(result.error.median, result.error.rms);
  EXPECT_GT(result.error.max, 2.0 * result.error.median);
  EXPECT_EQ(result.coverage, 0.0);
}

TEST(AbsoluteError, AScaleFreeTrajectoryAlignsWithScaleAlone) {
  const std::vector<EvaluatedTrajectory> sessions = {
      {.name = "a", .estimate = InMap(Flight(20.0), 0.25), .truth = Flight(200.0), .body_from_evaluated = {}}};
  AbsoluteErrorOptions options;
  EXPECT_GT(Evaluate(sessions, options).error.rms, 0.5);
  options.with_scale = true;
  const AbsoluteError result = Evaluate(sessions, options);
  EXPECT_LT(result.error.rms, 1e-9);
  EXPECT_NEAR(result.truth_from_estimate.scale(), 4.0, 1e-9);
}

TEST(AbsoluteError, TruthIsInterpolatedBetweenItsSamplesButNotAcrossGaps) {
  std::vector<StampedPose> truth = Flight(200.0);
  const AbsoluteErrorOptions options;
  const auto between = InterpolatePose(truth, kStart + kSecond + 1'250'000, options);
  ASSERT_TRUE(between);
  EXPECT_LT((between->Inverse() * PoseAt(1.00125)).Log().norm(), 2e-5);
  std::erase_if(truth, [](const StampedPose& pose) {
    return pose.stamp_ns > kStart + 2 * kSecond && pose.stamp_ns < kStart + 3 * kSecond;
  });
  EXPECT_FALSE(InterpolatePose(truth, kStart + 2 * kSecond + kSecond / 2, options));
  EXPECT_TRUE(InterpolatePose(truth, kStart + 2 * kSecond, options));
  EXPECT_TRUE(InterpolatePose(truth, kStart + 3 * kSecond - 900'000, options));
  EXPECT_FALSE(InterpolatePose(truth, kStart - kSecond, options));
  EXPECT_FALSE(InterpolatePose({}, kStart, options));
}

TEST(AbsoluteError, TruthAtTenHertzServesFramesAtItsVeryStamps) {
  const AbsoluteError result =
      Evaluate({{.name = "a", .estimate = InMap(Flight(10.0)), .truth = Flight(10.0), .body_from_evaluated = {}}});
  EXPECT_EQ(result.error.count, 80U);
  EXPECT_LT(result.error.rms, 1e-9);
}

TEST(AbsoluteError, SessionsUnderOneAlignmentShowHowTheyLieToEachOther) {
  const EvaluatedTrajectory first{
      .name = "a", .estimate = InMap(Flight(20.0)), .truth = Flight(200.0), .body_from_evaluated = {}};
  EvaluatedTrajectory second{
      .name = "b", .estimate = InMap(Flight(20.0, 1.0)), .truth = Flight(200.0, 1.0), .body_from_evaluated = {}};
  EXPECT_LT(Evaluate({first, second}).error.rms, 1e-9);
  for (StampedPose& pose : second.estimate) {
    pose.world_from_body = Rigid3d(Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.0}) * pose.world_from_body;
  }
  EXPECT_LT(Evaluate({second}).error.rms, 1e-9);
  const AbsoluteError joint = Evaluate({first, second});
  EXPECT_GT(joint.error.rms, 0.1);
  EXPECT_EQ(joint.error.count, 320U);
  EXPECT_EQ(joint.sessions.size(), 2U);
}

TEST(AbsoluteError, AnotherPointOfTheBodySeesRotationErrors) {
  EvaluatedTrajectory session{.name = "a", .estimate = Flight(20.0), .truth = Flight(200.0), .body_from_evaluated = {}};
  int i = 0;
  for (StampedPose& pose : session.estimate) {
    const Eigen::Vector3d turn(0.0, 0.0, i++ % 2 == 0 ? 0.1 : -0.1);
    pose.world_from_body = Rigid3d(pose.world_from_body.rotation() * ExpSo3(turn), pose.world_from_body.translation());
  }
  EXPECT_LT(Evaluate({session}).error.rms, 1e-4);
  EXPECT_NEAR(Evaluate({session}).error.rotation_rms, 5.73, 0.01);  // 0.1 rad
  session.body_from_evaluated = Rigid3d(Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0});
  EXPECT_NEAR(Evaluate({session}).error.rms, 0.1, 0.02);
}

TEST(AbsoluteError, AStillCameraAndAStraightLineAlignByTheirOrientations) {
  for (const double speed : {0.0, 2.0}) {
    std::vector<StampedPose> truth;
    for (int i = 0; i < 100; ++i) {
      truth.push_back(
          {kStart + i * kSecond / 100, Rigid3d(Eigen::Quaterniond(0.9, 0.1, 0.2, 0.3), {speed * i / 100.0, 0.0, 0.0})});
    }
    const AbsoluteError result =
        Evaluate({{.name = "a", .estimate = InMap(truth), .truth = truth, .body_from_evaluated = {}}});
    EXPECT_LT(result.error.rms, 1e-9) << speed;
    EXPECT_LT((result.truth_from_estimate.rotation() * kMapFromWorld.rotation()).vec().norm(), 1e-6) << speed;
  }
}

TEST(AbsoluteError, WithoutCommonTimesThereIsNothingToCompare) {
  const std::vector<EvaluatedTrajectory> sessions = {
      {.name = "a", .estimate = Flight(20.0), .truth = {}, .body_from_evaluated = {}}};
  EXPECT_FALSE(EvaluateAbsoluteError(sessions));
}

TEST(EvaluationReport, TableAndJsonHoldEverySessionAndTheJointFigure) {
  const EvaluatedTrajectory session{.name = "flight_1",
                                    .estimate = InMap(Flight(20.0)),
                                    .truth = Flight(200.0),
                                    .body_from_evaluated = {},
                                    .dataset_frames = 160};
  EvaluationReport report;
  report.alone.push_back({Evaluate({session}), {.maps = 1, .keyframes = 42, .landmarks = std::nullopt}});
  report.joint = Evaluate({session, session});
  const std::string table = FormatTable(report);
  EXPECT_THAT(table, ::testing::ContainsRegex("flight_1 +160 +160 +100.0 % +0.0000"));
  EXPECT_THAT(table, ::testing::ContainsRegex("jointly +320 +320"));
  const nlohmann::json json = ToJson(report);
  EXPECT_EQ(json["alignment"], "se3");
  EXPECT_EQ(json["sessions"][0]["keyframes"], 42);
  EXPECT_FALSE(json["sessions"][0].contains("landmarks"));
  EXPECT_LT(json["joint"]["ate"]["rms_m"].get<double>(), 1e-9);
}

}  // namespace
}  // namespace pangaea
