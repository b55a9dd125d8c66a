#include "cli/evaluation.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "common/evaluation/trajectory_file.h"

namespace pangaea {
namespace {

// What is known of a trajectory without truth.
AbsoluteError WithoutError(const EvaluatedTrajectory& trajectory) {
  SessionError session;
  session.name = trajectory.name;
  session.estimated = trajectory.estimate.size();
  session.dataset_frames = trajectory.dataset_frames;
  if (session.dataset_frames > 0) {
    session.coverage = static_cast<double>(session.estimated) / static_cast<double>(session.dataset_frames);
  }
  AbsoluteError error;
  error.coverage = session.coverage;
  error.sessions.push_back(std::move(session));
  return error;
}

Result<AbsoluteError> EvaluateAlone(const EvaluatedTrajectory& trajectory, const AbsoluteErrorOptions& options) {
  auto error = EvaluateAbsoluteError(std::span(&trajectory, 1), options);
  if (!error) return Fail(error.error().code, trajectory.name + ": " + error.error().message);
  return error;
}

bool HasTruth(const EvaluatedTrajectory& trajectory, const AbsoluteErrorOptions& options) {
  return std::ranges::any_of(trajectory.estimate, [&](const StampedPose& pose) {
    return InterpolatePose(trajectory.truth, pose.stamp_ns, options).has_value();
  });
}

Result<MapEvaluation> EvaluateMap(const StoredAtlas& stored, MapId map, const AbsoluteErrorOptions& options) {
  const MapInfo& info = *stored.atlas().FindMap(map);
  MapEvaluation evaluation{.map = map, .report = {}, .truth_from_map = {}};
  EvaluationReport& report = evaluation.report;
  report.with_scale = options.with_scale;
  report.total = {.maps = {}, .keyframes = info.keyframes, .landmarks = info.landmarks};
  std::vector<EvaluatedTrajectory> with_truth;
  for (const SessionPart& part : stored.parts) {
    if (part.map != map) continue;
    const bool has_truth = HasTruth(part.trajectory, options);
    auto error = has_truth ? EvaluateAlone(part.trajectory, options) : WithoutError(part.trajectory);
    if (!error) return tl::make_unexpected(error.error());
    report.alone.push_back({std::move(*error), part.counts});
    if (!has_truth) continue;
    evaluation.truth_from_map = report.alone.back().error.truth_from_estimate;
    with_truth.push_back(part.trajectory);
  }
  if (with_truth.size() < 2) return evaluation;
  auto joint = EvaluateAbsoluteError(with_truth, options);
  if (!joint) return tl::make_unexpected(joint.error());
  evaluation.truth_from_map = joint->truth_from_estimate;
  report.joint = std::move(*joint);
  return evaluation;
}

}  // namespace

Result<std::vector<MapEvaluation>> EvaluateMaps(const StoredAtlas& stored, const AbsoluteErrorOptions& options) {
  if (auto status = options.Check(); !status) return tl::make_unexpected(status.error());
  std::vector<MapEvaluation> evaluations;
  for (const MapId map : stored.maps) {
    auto evaluation = EvaluateMap(stored, map, options);
    if (!evaluation) return tl::make_unexpected(evaluation.error());
    if (!evaluation->report.alone.empty()) evaluations.push_back(std::move(*evaluation));
  }
  return evaluations;
}

Result<EvaluationReport> EvaluateTrajectories(std::span<const EvaluatedTrajectory> trajectories, bool jointly,
                                              const AbsoluteErrorOptions& options) {
  EvaluationReport report;
  report.with_scale = options.with_scale;
  for (const EvaluatedTrajectory& trajectory : trajectories) {
    auto error = EvaluateAlone(trajectory, options);
    if (!error) return tl::make_unexpected(error.error());
    report.alone.push_back({std::move(*error), {}});
  }
  if (!jointly) return report;
  auto joint = EvaluateAbsoluteError(trajectories, options);
  if (!joint) return tl::make_unexpected(joint.error());
  report.joint = std::move(*joint);
  return report;
}

Result<std::vector<EvaluatedTrajectory>> ReadTrajectories(const std::vector<std::string>& files,
                                                          std::span<const Truth> truths, bool of_camera) {
  if (files.size() != truths.size()) {
    return Fail(ErrorCode::kInvalidArgument, std::to_string(files.size()) + " --trajectory and " +
                                                 std::to_string(truths.size()) +
                                                 " --truth: each trajectory needs one truth, in the same order");
  }
  std::vector<EvaluatedTrajectory> trajectories;
  for (std::size_t i = 0; i < files.size(); ++i) {
    auto poses = ReadTrajectory(files[i]);
    if (!poses) return tl::make_unexpected(poses.error());
    const Truth& truth = truths[i];
    if (of_camera && !truth.body_from_camera) {
      return Fail(ErrorCode::kInvalidArgument,
                  "--camera: " + truth.source + " does not say where the camera is on the body; give the dataset");
    }
    if (truth.poses.empty()) return Fail(ErrorCode::kNotFound, truth.source + ": has no ground truth");
    trajectories.push_back({.name = std::filesystem::path(files[i]).stem().string(),
                            .estimate = std::move(*poses),
                            .truth = truth.poses,
                            .body_from_evaluated = of_camera ? *truth.body_from_camera : Rigid3d(),
                            .dataset_frames = truth.frames});
  }
  return trajectories;
}

}  // namespace pangaea
