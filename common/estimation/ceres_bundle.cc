#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "common/estimation/bundle_cost.h"
#include "common/estimation/bundle_phase.h"
#include "common/estimation/ceres_run.h"

namespace pangaea {
namespace {

ceres::LinearSolverType LinearSolver(BundleSolver solver) {
  switch (solver) {
    case BundleSolver::kSparseSchur:
      return ceres::SPARSE_SCHUR;
    case BundleSolver::kIterativeSchur:
      return ceres::ITERATIVE_SCHUR;
    case BundleSolver::kDenseSchur:
    case BundleSolver::kLocal:
    case BundleSolver::kSparse:
      break;
  }
  return ceres::DENSE_SCHUR;
}

class CeresBundle {
 public:
  CeresBundle(const BundlePhase& phase, BundleState& state)
      : phase_(phase),
        state_(state),
        problem_(ProblemOptions()),
        monocular_kernel_(std::sqrt(phase.bends.monocular)),
        stereo_kernel_(std::sqrt(phase.bends.stereo)) {
    poses_.reserve(state.camera_from_map.size());
    for (const Rigid3d& pose : state.camera_from_map) poses_.push_back(ToParameters(pose));
    pose_used_.assign(poses_.size(), 0);
    point_used_.assign(state.point_in_map.size(), 0);
    for (std::size_t i = 0; i < phase.problem.observations.size(); ++i) {
      if (phase.active[i] != 0) AddResidual(phase.problem.observations[i]);
    }
  }

  PhaseOutcome Run() {
    SilenceCeresWarnings();
    ceres::Solver::Options options = SolverOptions();
    CeresStopCallback stop(phase_.options.stop);
    options.callbacks.push_back(&stop);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (pose_used_[i] != 0 && !phase_.problem.poses[i].fixed) state_.camera_from_map[i] = ToRigid(poses_[i]);
    }
    PhaseOutcome outcome;
    outcome.initial_cost = summary.initial_cost;
    outcome.final_cost = summary.final_cost;
    outcome.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps - 1;
    outcome.converged = summary.termination_type == ceres::CONVERGENCE;
    outcome.cancelled = stop.stopped();
    return outcome;
  }

 private:
  static ceres::Problem::Options ProblemOptions() {
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  void AddResidual(const BundleObservation& observation) {
    const BundlePose& pose = phase_.problem.poses[observation.pose];
    double* pose_block = poses_[observation.pose].data();
    double* point_block = state_.point_in_map[observation.point].data();
    const bool stereo = IsStereo(observation.measurement);
    ceres::LossFunction* kernel = stereo ? &stereo_kernel_ : &monocular_kernel_;
    problem_.AddResidualBlock(MakeBundleCost(phase_.problem.cameras[pose.camera], observation).release(),
                              phase_.bends == kNoKernel ? nullptr : kernel, pose_block, point_block);
    if (pose_used_[observation.pose] == 0) {
      pose_used_[observation.pose] = 1;
      if (pose.fixed) {
        problem_.SetParameterBlockConstant(pose_block);
      } else {
        problem_.SetManifold(pose_block, &manifold_);
      }
    }
    if (point_used_[observation.point] == 0) {
      point_used_[observation.point] = 1;
      if (phase_.problem.points[observation.point].fixed) problem_.SetParameterBlockConstant(point_block);
    }
  }

  ceres::Solver::Options SolverOptions() {
    ceres::Solver::Options options;
    options.linear_solver_type = LinearSolver(phase_.options.solver);
    if (options.linear_solver_type == ceres::ITERATIVE_SCHUR) {
      options.preconditioner_type = ceres::SCHUR_JACOBI;
    }
    options.max_num_iterations = phase_.iterations;
    options.function_tolerance = phase_.options.cost_tolerance;
    options.gradient_tolerance = 0.0;
    options.parameter_tolerance = 0.0;
    options.num_threads = phase_.options.threads;
    options.logging_type = ceres::SILENT;
    if (phase_.options.max_seconds > 0.0) options.max_solver_time_in_seconds = phase_.options.max_seconds;
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (std::size_t i = 0; i < point_used_.size(); ++i) {
      if (point_used_[i] != 0) ordering->AddElementToGroup(state_.point_in_map[i].data(), 0);
    }
    for (std::size_t i = 0; i < pose_used_.size(); ++i) {
      if (pose_used_[i] != 0) ordering->AddElementToGroup(poses_[i].data(), 1);
    }
    options.linear_solver_ordering = std::move(ordering);
    return options;
  }

  const BundlePhase& phase_;
  BundleState& state_;
  PoseManifold manifold_;
  std::vector<PoseParameters> poses_;
  std::vector<std::uint8_t> pose_used_;
  std::vector<std::uint8_t> point_used_;
  ceres::Problem problem_;
  ceres::HuberLoss monocular_kernel_;
  ceres::HuberLoss stereo_kernel_;
};

}  // namespace

PhaseOutcome RunCeresPhase(const BundlePhase& phase, BundleState& state) { return CeresBundle(phase, state).Run(); }

}  // namespace pangaea
