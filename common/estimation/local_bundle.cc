#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/estimation/bundle_phase.h"
#include "common/estimation/local_bundle_layout.h"
#include "common/estimation/reduced_system.h"

// Levenberg-Marquardt on the reduced camera system (Triggs et al., "Bundle Adjustment: A Modern Synthesis", 2000,
// section 6.1), which is dense or sparse. Observations lie sorted by point, so that
// eliminating the points walks through memory once.

namespace pangaea {
namespace {

using namespace local_bundle;
using Matrix63d = Eigen::Matrix<double, 6, 3>;

// A long step looks for a stop whenever it has eliminated so many points: some milliseconds.
constexpr std::size_t kTracksBetweenStops = 1024;
constexpr double kInitialDamping = 1e-4;
constexpr double kMinDamping = 1e-10;
constexpr double kMaxDamping = 1e16;
// The damped diagonal lies in this range, so that variables without information stay where they are.
constexpr double kMinDiagonal = 1e-6;
constexpr double kMaxDiagonal = 1e32;

// Half the derivatives of the cost by everything free.
struct Equations {
  std::vector<Matrix6d> pose_block;          // per free pose
  std::vector<Vector6d> pose_gradient;       // per free pose
  std::vector<Eigen::Matrix3d> point_block;  // per track
  std::vector<Eigen::Vector3d> point_gradient;
  std::vector<Matrix63d> mixed_block;  // per measurement; only those of free pose and free point are set
};

struct Step {
  Eigen::VectorXd poses;                // 6 per free pose
  std::vector<Eigen::Vector3d> points;  // per track
  double predicted_decrease = 0.0;
};

template <typename ReducedSystem>
class LocalBundle {
 public:
  LocalBundle(const BundlePhase& phase, BundleState& state)
      : phase_(phase),
        state_(state),
        layout_(MakeLayout(phase, state)),
        trial_cameras_(layout_.cameras),
        trial_poses_(state.camera_from_map),
        trial_points_(state.point_in_map),
        reduced_(layout_) {
    const std::size_t poses = layout_.free_poses.size();
    equations_.pose_block.resize(poses);
    equations_.pose_gradient.resize(poses);
    equations_.point_block.resize(layout_.tracks.size());
    equations_.point_gradient.resize(layout_.tracks.size());
    equations_.mixed_block.resize(layout_.measurements.size());
    step_.poses.resize(static_cast<Eigen::Index>(6 * poses));
    step_.points.assign(layout_.tracks.size(), Eigen::Vector3d::Zero());
    reduced_gradient_.resize(step_.poses.size());
    inverse_.resize(layout_.tracks.size());
  }

  PhaseOutcome Run() {
    PhaseOutcome outcome;
    double cost = Linearize();
    outcome.initial_cost = 0.5 * cost;
    double damping = kInitialDamping;
    double growth = 2.0;
    while (outcome.iterations < phase_.iterations && damping < kMaxDamping && !outcome.converged) {
      ++outcome.iterations;
      const bool solved = SolveStep(damping);
      const double trial_cost = solved ? TrialCost() : std::numeric_limits<double>::infinity();
      const double decrease = cost - trial_cost;
      if (solved && decrease >= 0.0) {
        TakeTrial();
        outcome.converged = decrease <= phase_.options.cost_tolerance * cost;
        cost = trial_cost;
        // Nielsen's damping: a step as good as predicted divides it by three (Madsen et al. 2004, Eq. 2.21).
        const double quality = step_.predicted_decrease > 0.0 ? decrease / step_.predicted_decrease : 1.0;
        damping = std::max(kMinDamping, damping * std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * quality - 1.0, 3)));
        growth = 2.0;
      } else {
        // Nothing left to gain but rounding errors.
        outcome.converged = solved && step_.predicted_decrease <= phase_.options.cost_tolerance * cost;
        damping *= growth;
        growth *= 2.0;
      }
      if (phase_.options.stop.stop_requested()) {
        outcome.cancelled = true;
        break;
      }
      if (phase_.options.out_of_time && phase_.options.out_of_time()) break;
      const bool is_last = outcome.iterations == phase_.iterations || outcome.converged;
      if (solved && decrease >= 0.0 && !is_last) Linearize();
    }
    outcome.final_cost = 0.5 * cost;
    return outcome;
  }

 private:
  // Fills the equations at the current state; returns the sum of the kernel of the squared residuals.
  double Linearize() {
    std::fill(equations_.pose_block.begin(), equations_.pose_block.end(), Matrix6d::Zero());
    std::fill(equations_.pose_gradient.begin(), equations_.pose_gradient.end(), Vector6d::Zero());
    double cost = 0.0;
    for (std::size_t t = 0; t < layout_.tracks.size(); ++t) cost += LinearizeTrack(t);
    return cost;
  }

  double LinearizeTrack(std::size_t t) {
    const Track& track = layout_.tracks[t];
    const Eigen::Vector3d point_in_map = state_.point_in_map[track.point];
    Eigen::Matrix3d point_block = Eigen::Matrix3d::Zero();
    Eigen::Vector3d point_gradient = Eigen::Vector3d::Zero();
    double cost = 0.0;
    for (int m = track.begin; m < track.end; ++m) {
      const Camera& camera = layout_.cameras[layout_.measurements[m].camera];
      const View view = LookAt(camera, layout_.measurements[m], point_in_map);
      cost += view.cost;
      const int variable = camera.variable;
      if (variable >= 0) AddPoseBlock(view, equations_.pose_block[variable], equations_.pose_gradient[variable]);
      if (track.fixed) continue;
      Eigen::Matrix3d weighted;  // A * rotation
      weighted.row(0) = view.xx * camera.rotation.row(0) + view.xz * camera.rotation.row(2);
      weighted.row(1) = view.yy * camera.rotation.row(1) + view.yz * camera.rotation.row(2);
      weighted.row(2) =
          view.xz * camera.rotation.row(0) + view.yz * camera.rotation.row(1) + view.zz * camera.rotation.row(2);
      point_block.noalias() += camera.rotation.transpose() * weighted;
      point_gradient.noalias() += camera.rotation.transpose() * view.gradient;
      if (variable < 0) continue;
      Matrix63d& mixed = equations_.mixed_block[m];
      for (int c = 0; c < 3; ++c) {
        const Eigen::Vector3d column = weighted.col(c);
        mixed.col(c).head<3>() = column;
        mixed.col(c).tail<3>() = view.point_in_camera.cross(column);
      }
    }
    equations_.point_block[t] = point_block;
    equations_.point_gradient[t] = point_gradient;
    return cost;
  }

  static double Damped(double diagonal, double damping) {
    return damping * std::clamp(diagonal, kMinDiagonal, kMaxDiagonal);
  }

  // Solves (H + damping * diag(H)) step = -gradient through the reduced camera system. False when that is not
  // positive definite in floating point, or a stop was requested during a long step.
  bool SolveStep(double damping) {
    StartReducedSystem(damping);
    for (std::size_t t = 0; t < layout_.tracks.size(); ++t) {
      if (ReducedSystem::kStepsAreLong && t % kTracksBetweenStops == 0 && phase_.options.stop.stop_requested()) {
        return false;
      }
      if (!layout_.tracks[t].fixed) Eliminate(t, damping);
    }
    if (!layout_.free_poses.empty()) {
      if (!reduced_.Factorize()) return false;
      step_.poses = -reduced_.Solve(reduced_gradient_);
    }
    for (std::size_t t = 0; t < layout_.tracks.size(); ++t) {
      if (!layout_.tracks[t].fixed) Substitute(t);
    }
    Predict(damping);
    return step_.poses.allFinite() && std::isfinite(step_.predicted_decrease);
  }

  void StartReducedSystem(double damping) {
    reduced_.SetZero();
    for (std::size_t i = 0; i < layout_.free_poses.size(); ++i) {
      const int variable = static_cast<int>(i);
      Matrix6d block = equations_.pose_block[i].selfadjointView<Eigen::Upper>();
      for (int k = 0; k < 6; ++k) block(k, k) += Damped(block(k, k), damping);
      reduced_.Block(variable, variable) = block;
      reduced_gradient_.template segment<6>(6 * variable) = equations_.pose_gradient[i];
    }
  }

  // Subtracts W V^-1 W' of one point from the lower triangle of the reduced system.
  void Eliminate(std::size_t t, double damping) {
    const Track& track = layout_.tracks[t];
    Eigen::Matrix3d block = equations_.point_block[t];
    for (int k = 0; k < 3; ++k) block(k, k) += Damped(block(k, k), damping);
    inverse_[t] = block.inverse();
    for (int m = track.begin; m < track.free_end; ++m) {
      const Matrix63d product = equations_.mixed_block[m] * inverse_[t];
      const int row = VariableOf(m);
      reduced_gradient_.template segment<6>(6 * row).noalias() -= product * equations_.point_gradient[t];
      for (int n = track.begin; n <= m; ++n) {
        const int column = VariableOf(n);
        auto&& target = reduced_.Block(row, column);
        target.noalias() -= product * equations_.mixed_block[n].transpose();
        // The same pose saw the point twice: both orders belong to its diagonal block.
        if (row == column && n != m) target.noalias() -= equations_.mixed_block[n] * product.transpose();
      }
    }
  }

  void Substitute(std::size_t t) {
    const Track& track = layout_.tracks[t];
    Eigen::Vector3d right = equations_.point_gradient[t];
    for (int m = track.begin; m < track.free_end; ++m) {
      right.noalias() += equations_.mixed_block[m].transpose() * step_.poses.template segment<6>(6 * VariableOf(m));
    }
    step_.points[t] = -(inverse_[t] * right);
  }

  // The decrease of the (doubled) cost by the quadratic model: step' (damping D step - gradient).
  void Predict(double damping) {
    double decrease = 0.0;
    for (std::size_t i = 0; i < layout_.free_poses.size(); ++i) {
      const Vector6d step = step_.poses.template segment<6>(static_cast<Eigen::Index>(6 * i));
      decrease -= step.dot(equations_.pose_gradient[i]);
      for (int k = 0; k < 6; ++k) decrease += Damped(equations_.pose_block[i](k, k), damping) * step(k) * step(k);
    }
    for (std::size_t t = 0; t < layout_.tracks.size(); ++t) {
      if (layout_.tracks[t].fixed) continue;
      const Eigen::Vector3d& step = step_.points[t];
      decrease -= step.dot(equations_.point_gradient[t]);
      for (int k = 0; k < 3; ++k) decrease += Damped(equations_.point_block[t](k, k), damping) * step(k) * step(k);
    }
    step_.predicted_decrease = decrease;
  }

  // Applies the step to the trial state; returns the trial's cost.
  double TrialCost() {
    for (std::size_t i = 0; i < layout_.free_poses.size(); ++i) {
      const int pose = layout_.free_poses[i];
      const Vector6d step = step_.poses.template segment<6>(static_cast<Eigen::Index>(6 * i));
      trial_poses_[pose] = Rigid3d::Exp(step) * state_.camera_from_map[pose];
      trial_cameras_[pose].rotation = trial_poses_[pose].rotation().toRotationMatrix();
      trial_cameras_[pose].translation = trial_poses_[pose].translation();
    }
    double cost = 0.0;
    for (std::size_t t = 0; t < layout_.tracks.size(); ++t) {
      const Track& track = layout_.tracks[t];
      Eigen::Vector3d& point_in_map = trial_points_[track.point];
      if (!track.fixed) point_in_map = state_.point_in_map[track.point] + step_.points[t];
      for (int m = track.begin; m < track.end; ++m) {
        const Measurement& measurement = layout_.measurements[m];
        double weight = 1.0;
        const double squared = Project(trial_cameras_[measurement.camera], measurement, point_in_map).squared;
        cost += Huber(squared, measurement.bend, weight);
      }
    }
    return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
  }

  void TakeTrial() {
    std::swap(state_.camera_from_map, trial_poses_);
    std::swap(state_.point_in_map, trial_points_);
    std::swap(layout_.cameras, trial_cameras_);
  }

  int VariableOf(int measurement) const { return layout_.cameras[layout_.measurements[measurement].camera].variable; }

  const BundlePhase& phase_;
  BundleState& state_;
  Layout layout_;
  std::vector<Camera> trial_cameras_;
  std::vector<Rigid3d> trial_poses_;
  std::vector<Eigen::Vector3d> trial_points_;
  Equations equations_;
  ReducedSystem reduced_;
  Eigen::VectorXd reduced_gradient_;
  std::vector<Eigen::Matrix3d> inverse_;  // per track
  Step step_;
};

}  // namespace

PhaseOutcome RunLocalPhase(const BundlePhase& phase, BundleState& state) {
  return phase.options.solver == BundleSolver::kSparse ? LocalBundle<SparseReducedSystem>(phase, state).Run()
                                                       : LocalBundle<DenseReducedSystem>(phase, state).Run();
}

}  // namespace pangaea
