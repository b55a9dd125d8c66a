#include "common/estimation/bundle_adjustment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "common/estimation/bundle_phase.h"
#include "common/estimation/measured_noise.h"

namespace pangaea {
namespace {

// Larger coordinates (map units, pixels, 1 / pixels) are garbage, and their squares would drown the others.
constexpr double kMaxMagnitude = 1e8;
constexpr double kAnyError = std::numeric_limits<double>::infinity();

[[nodiscard]] tl::unexpected<Error> Invalid(const std::string& what, std::size_t index, const char* why) {
  return Fail(ErrorCode::kInvalidArgument, "bundle adjustment: " + what + " " + std::to_string(index) + " " + why);
}

bool IsIndex(int index, std::size_t size) { return index >= 0 && static_cast<std::size_t>(index) < size; }

Status CheckPoses(const BundleProblem& problem) {
  for (std::size_t i = 0; i < problem.cameras.size(); ++i) {
    const IdealCamera& camera = problem.cameras[i];
    if (!(camera.focal_x > 0.0) || !(camera.focal_y > 0.0)) return Invalid("camera", i, "has no focal length");
  }
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    const BundlePose& pose = problem.poses[i];
    if (!pose.camera_from_map.AllFinite() || !IsWithinBounds(pose.camera_from_map.translation())) {
      return Invalid("pose", i, "is not finite");
    }
    if (!IsIndex(pose.camera, problem.cameras.size())) return Invalid("pose", i, "refers to an unknown camera");
  }
  return {};
}

Status CheckObservations(const BundleProblem& problem) {
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const BundleObservation& observation = problem.observations[i];
    if (!IsIndex(observation.pose, problem.poses.size())) return Invalid("observation", i, "refers to no pose");
    if (!IsIndex(observation.point, problem.points.size())) return Invalid("observation", i, "refers to no point");
    if (!IsWithinBounds(observation.measurement)) return Invalid("observation", i, "is not finite");
    if (!(observation.inverse_sigma > 0.0) || !(observation.inverse_sigma < kMaxMagnitude)) {
      return Invalid("observation", i, "has an inverse_sigma out of range");
    }
    const BundlePose& pose = problem.poses[observation.pose];
    if (IsStereo(observation.measurement) && !problem.cameras[pose.camera].is_stereo()) {
      return Invalid("observation", i, "is stereo, its camera is not");
    }
  }
  return {};
}

Status CheckProblem(const BundleProblem& problem) {
  if (const Status status = CheckPoses(problem); !status) return status;
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    if (!IsWithinBounds(problem.points[i].point_in_map)) return Invalid("point", i, "is not finite");
  }
  const auto fixed = [](const auto& variable) { return variable.fixed; };
  if (std::none_of(problem.poses.begin(), problem.poses.end(), fixed) &&
      std::count_if(problem.points.begin(), problem.points.end(), fixed) < 3) {
    return Fail(ErrorCode::kInvalidArgument, "bundle adjustment: fix at least one pose or three points");
  }
  return CheckObservations(problem);
}

BundleState InitialState(const BundleProblem& problem) {
  BundleState state;
  state.camera_from_map.reserve(problem.poses.size());
  state.point_in_map.reserve(problem.points.size());
  for (const BundlePose& pose : problem.poses) state.camera_from_map.push_back(pose.camera_from_map);
  for (const BundlePoint& point : problem.points) state.point_in_map.push_back(point.point_in_map);
  return state;
}

// Per observation 1 where it is in front of its camera and within its threshold for noise of so many of its sigmas.
std::vector<std::uint8_t> FindInliers(const BundleProblem& problem, const BundleState& state,
                                      const BundleOptions& options, double noise) {
  std::vector<std::uint8_t> inliers(problem.observations.size());
  for (std::size_t i = 0; i < inliers.size(); ++i) {
    const BundleObservation& observation = problem.observations[i];
    const IdealCamera& camera = problem.cameras[problem.poses[observation.pose].camera];
    const Eigen::Vector3d point_in_camera =
        state.camera_from_map[observation.pose] * state.point_in_map[observation.point];
    const Eigen::Vector3d error =
        observation.inverse_sigma * ReprojectionError(camera, point_in_camera, observation.measurement);
    const double chi2 = IsStereo(observation.measurement) ? options.stereo_chi2 : options.monocular_chi2;
    inliers[i] = point_in_camera.z() > kMinDepth && error.squaredNorm() <= noise * noise * chi2 ? 1 : 0;
  }
  return inliers;
}

double NoiseOf(const BundleProblem& problem, const BundleState& state, const BundleOptions& options) {
  if (options.least_noise >= 1.0) return 1.0;
  const double noise = MeasuredNoise(problem, state.camera_from_map, state.point_in_map);
  return std::min(1.0, kBeyondDoubt * std::max(noise, options.least_noise));
}

PhaseOutcome RunPhase(const BundlePhase& phase, BundleState& state) {
  const bool own = phase.options.solver == BundleSolver::kLocal || phase.options.solver == BundleSolver::kSparse;
  return own ? RunLocalPhase(phase, state) : RunCeresPhase(phase, state);
}

}  // namespace

Status BundleOptions::Check() const {
  const auto refuse = [](const char* what) {
    return Fail(ErrorCode::kInvalidArgument, std::string("bundle adjustment: ") + what);
  };
  if (!(monocular_chi2 > 0.0) || !(stereo_chi2 > 0.0)) return refuse("chi2 thresholds must be > 0");
  if (!(narrow_share >= kLeastShare)) return refuse("narrow_share must be >= 1e-6");
  if (!(least_noise > 0.0) || !(least_noise <= 1.0)) return refuse("least_noise must be above 0 and at most 1");
  if (iterations < 1) return refuse("iterations must be >= 1");
  if (iterations_without_outliers < 0) return refuse("iterations_without_outliers must be >= 0");
  if (!(cost_tolerance >= 0.0)) return refuse("cost_tolerance must be >= 0");
  if (threads < 1) return refuse("threads must be >= 1");
  if (!(max_seconds >= 0.0)) return refuse("max_seconds must be >= 0");
  return {};
}

bool IsWithinBounds(const Eigen::Vector3d& position) { return (position.array().abs() < kMaxMagnitude).all(); }

void StartFrom(const BundleResult& solution, BundleProblem& problem) {
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    const Rigid3d& pose = solution.poses[i];
    if (pose.AllFinite() && IsWithinBounds(pose.translation())) problem.poses[i].camera_from_map = pose;
  }
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    if (IsWithinBounds(solution.points[i])) problem.points[i].point_in_map = solution.points[i];
  }
}

Result<BundleResult> SolveBundle(const BundleProblem& problem, const BundleOptions& options) {
  if (const Status status = options.Check(); !status) return tl::make_unexpected(status.error());
  if (const Status status = CheckProblem(problem); !status) return tl::make_unexpected(status.error());

  const KernelBends wide{options.monocular_chi2, options.stereo_chi2};
  BundleState state = InitialState(problem);
  // A point behind its camera gives no usable direction of descent.
  std::vector<std::uint8_t> active = FindInliers(problem, state, options, kAnyError);
  PhaseOutcome outcome = RunPhase({problem, options, active, wide, options.iterations}, state);
  BundleResult result;
  result.initial_cost = outcome.initial_cost;
  result.iterations = outcome.iterations;
  const double noise = NoiseOf(problem, state, options);
  active = FindInliers(problem, state, options, noise);
  if (options.iterations_without_outliers > 0 && !outcome.cancelled) {
    const KernelBends narrow = Narrowed(wide, options.narrow_share * noise);
    outcome = RunPhase({problem, options, active, narrow, options.iterations_without_outliers}, state);
    result.iterations += outcome.iterations;
    active = FindInliers(problem, state, options, noise);
  }
  result.final_cost = outcome.final_cost;
  result.converged = outcome.converged;
  result.cancelled = outcome.cancelled;
  result.poses = std::move(state.camera_from_map);
  result.points = std::move(state.point_in_map);
  result.outliers = std::move(active);
  for (std::uint8_t& flag : result.outliers) flag = flag == 0 ? 1 : 0;
  return result;
}

}  // namespace pangaea
