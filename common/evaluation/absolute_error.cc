#include "common/evaluation/absolute_error.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/horn.h"

namespace pangaea {
namespace {

constexpr double kNanoseconds = 1e9;  // in a second

// The compared positions of one session, index by index, and the orientations that go with them.
struct Pairs {
  std::vector<Eigen::Vector3d> truth;
  std::vector<Eigen::Vector3d> estimate;
  std::vector<Eigen::Quaterniond> world_from_map;       // by each pose alone: world_from_body * map_from_body^-1
  Eigen::Matrix3d rotations = Eigen::Matrix3d::Zero();  // their sum
};

Pairs Associate(const EvaluatedTrajectory& session, const AbsoluteErrorOptions& options) {
  Pairs pairs;
  for (const StampedPose& pose : session.estimate) {
    const auto truth = InterpolatePose(session.truth, pose.stamp_ns, options);
    if (!truth) continue;
    pairs.truth.push_back(*truth * session.body_from_evaluated.translation());
    pairs.estimate.push_back(pose.world_from_body * session.body_from_evaluated.translation());
    pairs.world_from_map.push_back(truth->rotation() * pose.world_from_body.rotation().conjugate());
    pairs.rotations += pairs.world_from_map.back().toRotationMatrix();
  }
  return pairs;
}

Eigen::Vector3d Mean(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

// Where positions leave the rotation open (a still camera, a straight line), the orientations say what it is: their
// chordal mean.
Similarity3d AlignByOrientation(const Pairs& pairs) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(pairs.rotations, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  const Eigen::Quaterniond rotation(Eigen::Matrix3d(svd.matrixU() * sign * svd.matrixV().transpose()));
  return Similarity3d(1.0, rotation, Mean(pairs.truth) - rotation * Mean(pairs.estimate));
}

struct Errors {
  std::vector<double> distances;  // metres
  std::vector<double> angles;     // degrees

  void Add(const Errors& others) {
    distances.insert(distances.end(), others.distances.begin(), others.distances.end());
    angles.insert(angles.end(), others.angles.begin(), others.angles.end());
  }
};

double RootMeanSquare(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return values.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(values.size()));
}

ErrorStatistics Summarise(Errors all) {
  std::vector<double>& errors = all.distances;
  ErrorStatistics statistics;
  statistics.rotation_rms = RootMeanSquare(all.angles);
  statistics.count = errors.size();
  if (errors.empty()) return statistics;
  std::ranges::sort(errors);
  for (const double error : errors) statistics.mean += error / static_cast<double>(errors.size());
  statistics.rms = RootMeanSquare(errors);
  statistics.median = 0.5 * (errors[(errors.size() - 1) / 2] + errors[errors.size() / 2]);
  statistics.max = errors.back();
  return statistics;
}

double PathLength(const std::vector<Eigen::Vector3d>& positions) {
  double length = 0.0;
  for (std::size_t i = 1; i < positions.size(); ++i) length += (positions[i] - positions[i - 1]).norm();
  return length;
}

double Ratio(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

SessionError Measure(const EvaluatedTrajectory& session, const Pairs& pairs, const Similarity3d& truth_from_estimate,
                     Errors& all_errors) {
  Errors errors;
  for (std::size_t i = 0; i < pairs.truth.size(); ++i) {
    errors.distances.push_back((pairs.truth[i] - truth_from_estimate * pairs.estimate[i]).norm());
    errors.angles.push_back(pairs.world_from_map[i].angularDistance(truth_from_estimate.rotation()) * 180.0 /
                            std::numbers::pi);
  }
  all_errors.Add(errors);
  SessionError result;
  result.name = session.name;
  result.error = Summarise(std::move(errors));
  result.estimated = session.estimate.size();
  result.dataset_frames = session.dataset_frames;
  result.coverage = Ratio(result.estimated, result.dataset_frames);
  result.path_length = PathLength(pairs.truth);
  return result;
}

}  // namespace

Status AbsoluteErrorOptions::Check() const {
  if (!(max_truth_gap_s >= 0.0 && max_truth_gap_s <= 10.0)) {
    return Fail(ErrorCode::kInvalidArgument, "max_truth_gap_s: allowed: 0 to 10 seconds");
  }
  if (!(stamp_tolerance_s >= 0.0 && stamp_tolerance_s <= 1.0)) {
    return Fail(ErrorCode::kInvalidArgument, "stamp_tolerance_s: allowed: 0 to 1 second");
  }
  return {};
}

std::optional<Rigid3d> InterpolatePose(std::span<const StampedPose> truth, std::int64_t stamp_ns,
                                       const AbsoluteErrorOptions& options) {
  const auto seconds = [](std::int64_t from, std::int64_t to) { return static_cast<double>(to - from) / kNanoseconds; };
  const auto after = std::ranges::lower_bound(truth, stamp_ns, {}, &StampedPose::stamp_ns);
  const bool has_before = after != truth.begin();
  const bool has_after = after != truth.end();
  if (has_before && has_after && seconds((after - 1)->stamp_ns, after->stamp_ns) <= options.max_truth_gap_s) {
    const StampedPose& before = *(after - 1);
    const double part = seconds(before.stamp_ns, stamp_ns) / seconds(before.stamp_ns, after->stamp_ns);
    const Eigen::Vector3d translation =
        (1.0 - part) * before.world_from_body.translation() + part * after->world_from_body.translation();
    return Rigid3d(before.world_from_body.rotation().slerp(part, after->world_from_body.rotation()), translation);
  }
  if (has_after && seconds(stamp_ns, after->stamp_ns) <= options.stamp_tolerance_s) return after->world_from_body;
  if (has_before && seconds((after - 1)->stamp_ns, stamp_ns) <= options.stamp_tolerance_s) {
    return (after - 1)->world_from_body;
  }
  return std::nullopt;
}

Result<AbsoluteError> EvaluateAbsoluteError(std::span<const EvaluatedTrajectory> sessions,
                                            const AbsoluteErrorOptions& options) {
  if (auto status = options.Check(); !status) return tl::make_unexpected(status.error());
  std::vector<Pairs> pairs;
  Pairs all;
  for (const EvaluatedTrajectory& session : sessions) {
    pairs.push_back(Associate(session, options));
    all.truth.insert(all.truth.end(), pairs.back().truth.begin(), pairs.back().truth.end());
    all.estimate.insert(all.estimate.end(), pairs.back().estimate.begin(), pairs.back().estimate.end());
    all.rotations += pairs.back().rotations;
  }
  if (all.truth.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "no pose of the trajectory has ground truth at its time");
  }
  AbsoluteError result;
  result.truth_from_estimate =
      AlignPoints(all.truth, all.estimate, options.with_scale).value_or(AlignByOrientation(all));
  Errors errors;
  std::size_t estimated = 0;
  std::size_t frames = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    result.sessions.push_back(Measure(sessions[i], pairs[i], result.truth_from_estimate, errors));
    estimated += result.sessions.back().estimated;
    frames += result.sessions.back().dataset_frames;
  }
  result.error = Summarise(std::move(errors));
  result.coverage = Ratio(estimated, frames);
  return result;
}

}  // namespace pangaea
