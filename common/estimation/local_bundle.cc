#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "common/estimation/bundle_phase.h"

// Levenberg-Marquardt on the reduced camera system (Triggs et al., "Bundle Adjustment: A Modern Synthesis", 2000,
// section 6.1), for problems whose reduced system is small and dense. Observations lie sorted by point, so that
// eliminating the points walks through memory once.

namespace pangaea {
namespace {

using Matrix63d = Eigen::Matrix<double, 6, 3>;

constexpr double kInitialDamping = 1e-4;
constexpr double kMinDamping = 1e-10;
constexpr double kMaxDamping = 1e16;
// The damped diagonal lies in this range, so that variables without information stay where they are.
constexpr double kMinDiagonal = 1e-6;
constexpr double kMaxDiagonal = 1e32;

struct Camera {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  double focal_x, focal_y, center_x, center_y, baseline;
  int variable;  // index among the free poses, -1: fixed
};

struct Measurement {
  double u, v, u_right;
  double squared_weight;  // inverse_sigma^2
  double bend;            // of Huber's kernel, a squared residual in sigmas
  int camera;
  bool stereo;
};

// A run of measurements [begin, end) of one point; those up to `free_end` are by free poses, in their order.
struct Track {
  int begin, free_end, end;
  int point;
  bool fixed;
};

// One camera's view of a point. With A = J' w J, J the projection's derivative by the point in the camera:
struct View {
  Eigen::Vector3d point_in_camera;
  double xx, xz, yy, yz, zz;  // A; its (x, y) entry is 0
  Eigen::Vector3d gradient;   // J' w error
  double cost;                // kernel of the squared residual
};

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

inline double Huber(double squared, double bend, double& weight) {
  if (squared <= bend) {
    weight = 1.0;
    return squared;
  }
  weight = std::sqrt(bend / squared);
  return 2.0 * weight * squared - bend;
}

struct Residual {
  double x, y, z, inverse_depth;
  double u, v, r;
  double squared;
};

inline Residual Project(const Camera& camera, const Measurement& measurement, const Eigen::Vector3d& point_in_map) {
  const Eigen::Vector3d p = camera.rotation * point_in_map + camera.translation;
  Residual e;
  e.x = p.x();
  e.y = p.y();
  e.z = p.z();
  e.inverse_depth = 1.0 / std::max(e.z, kMinDepth);
  const double a = camera.focal_x * e.inverse_depth;
  e.u = a * e.x + camera.center_x - measurement.u;
  e.v = camera.focal_y * e.inverse_depth * e.y + camera.center_y - measurement.v;
  e.r = measurement.stereo ? a * (e.x - camera.baseline) + camera.center_x - measurement.u_right : 0.0;
  e.squared = measurement.squared_weight * (e.u * e.u + e.v * e.v + e.r * e.r);
  return e;
}

inline View LookAt(const Camera& camera, const Measurement& measurement, const Eigen::Vector3d& point_in_map) {
  const Residual e = Project(camera, measurement, point_in_map);
  View view;
  double weight = 1.0;
  view.cost = Huber(e.squared, measurement.bend, weight);
  const double w = weight * measurement.squared_weight;
  const double slope = e.z > kMinDepth ? e.inverse_depth : 0.0;
  const double a = camera.focal_x * e.inverse_depth;
  const double b = camera.focal_y * e.inverse_depth;
  const double du = -a * e.x * slope;
  const double dv = -b * e.y * slope;
  const double s = measurement.stereo ? 1.0 : 0.0;
  const double dr = -s * a * (e.x - camera.baseline) * slope;
  view.point_in_camera = {e.x, e.y, e.z};
  view.xx = w * a * a * (1.0 + s);
  view.xz = w * a * (du + dr);
  view.yy = w * b * b;
  view.yz = w * b * dv;
  view.zz = w * (du * du + dv * dv + dr * dr);
  view.gradient = {w * a * (e.u + e.r), w * b * e.v, w * (du * e.u + dv * e.v + dr * e.r)};
  return view;
}

// Adds G' A G, G = (I, -[p]x): the information of a pose perturbed on the left. Upper triangle only.
inline void AddPoseBlock(const View& view, Matrix6d& block, Vector6d& gradient) {
  const double x = view.point_in_camera.x(), y = view.point_in_camera.y(), z = view.point_in_camera.z();
  const double c00 = y * view.xz, c01 = z * view.xx - x * view.xz, c02 = -y * view.xx;
  const double c10 = y * view.yz - z * view.yy, c11 = -x * view.yz, c12 = x * view.yy;
  const double c20 = y * view.zz - z * view.yz, c21 = z * view.xz - x * view.zz, c22 = x * view.yz - y * view.xz;
  block(0, 0) += view.xx;
  block(0, 2) += view.xz;
  block(1, 1) += view.yy;
  block(1, 2) += view.yz;
  block(2, 2) += view.zz;
  block(0, 3) += c00;
  block(1, 3) += c10;
  block(2, 3) += c20;
  block(0, 4) += c01;
  block(1, 4) += c11;
  block(2, 4) += c21;
  block(0, 5) += c02;
  block(1, 5) += c12;
  block(2, 5) += c22;
  block(3, 3) += y * c20 - z * c10;
  block(3, 4) += y * c21 - z * c11;
  block(4, 4) += z * c01 - x * c21;
  block(3, 5) += y * c22 - z * c12;
  block(4, 5) += z * c02 - x * c22;
  block(5, 5) += x * c12 - y * c02;
  gradient.head<3>() += view.gradient;
  gradient.tail<3>() += view.point_in_camera.cross(view.gradient);
}

class LocalBundle {
 public:
  LocalBundle(const BundlePhase& phase, BundleState& state) : phase_(phase), state_(state) {
    AddCameras();
    AddTracks();
    const std::size_t poses = free_poses_.size();
    equations_.pose_block.resize(poses);
    equations_.pose_gradient.resize(poses);
    equations_.point_block.resize(tracks_.size());
    equations_.point_gradient.resize(tracks_.size());
    equations_.mixed_block.resize(measurements_.size());
    step_.poses.resize(static_cast<Eigen::Index>(6 * poses));
    step_.points.assign(tracks_.size(), Eigen::Vector3d::Zero());
    reduced_.resize(step_.poses.size(), step_.poses.size());
    reduced_gradient_.resize(step_.poses.size());
    inverse_.resize(tracks_.size());
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
      const bool is_last = outcome.iterations == phase_.iterations || outcome.converged;
      if (solved && decrease >= 0.0 && !is_last) Linearize();
    }
    outcome.final_cost = 0.5 * cost;
    return outcome;
  }

 private:
  void AddCameras() {
    const BundleProblem& problem = phase_.problem;
    for (std::size_t i = 0; i < problem.poses.size(); ++i) {
      const BundlePose& pose = problem.poses[i];
      const IdealCamera& ideal = problem.cameras[pose.camera];
      Camera camera{state_.camera_from_map[i].rotation().toRotationMatrix(),
                    state_.camera_from_map[i].translation(),
                    ideal.focal_x,
                    ideal.focal_y,
                    ideal.center_x,
                    ideal.center_y,
                    ideal.baseline,
                    -1};
      if (!pose.fixed) {
        camera.variable = static_cast<int>(free_poses_.size());
        free_poses_.push_back(static_cast<int>(i));
      }
      cameras_.push_back(camera);
    }
    trial_cameras_ = cameras_;
    trial_poses_ = state_.camera_from_map;
  }

  // Sorts the active observations by point, and by free pose within a point, fixed poses last.
  void AddTracks() {
    const BundleProblem& problem = phase_.problem;
    std::vector<int> order;
    order.reserve(problem.observations.size());
    for (std::size_t i = 0; i < problem.observations.size(); ++i) {
      if (phase_.active[i] != 0) order.push_back(static_cast<int>(i));
    }
    const auto key = [&](int index) {
      const BundleObservation& observation = problem.observations[index];
      const auto variable = static_cast<unsigned>(cameras_[observation.pose].variable);  // -1 becomes the largest
      return std::tuple(observation.point, variable, observation.pose, index);
    };
    std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
    measurements_.reserve(order.size());
    for (const int index : order) AddMeasurement(problem.observations[index]);
    trial_points_ = state_.point_in_map;
  }

  void AddMeasurement(const BundleObservation& observation) {
    const bool stereo = IsStereo(observation.measurement);
    const double bend = stereo ? phase_.options.stereo_chi2 : phase_.options.monocular_chi2;
    const int position = static_cast<int>(measurements_.size());
    measurements_.push_back({observation.measurement.x(), observation.measurement.y(), observation.measurement.z(),
                             observation.inverse_sigma * observation.inverse_sigma,
                             phase_.robust ? bend : std::numeric_limits<double>::max(), observation.pose, stereo});
    if (tracks_.empty() || tracks_.back().point != observation.point) {
      const bool fixed = phase_.problem.points[observation.point].fixed;
      tracks_.push_back({position, position, position, observation.point, fixed});
    }
    Track& track = tracks_.back();
    track.end = position + 1;
    if (cameras_[observation.pose].variable >= 0) track.free_end = position + 1;
  }

  // Fills the equations at the current state; returns the sum of the kernel of the squared residuals.
  double Linearize() {
    std::fill(equations_.pose_block.begin(), equations_.pose_block.end(), Matrix6d::Zero());
    std::fill(equations_.pose_gradient.begin(), equations_.pose_gradient.end(), Vector6d::Zero());
    double cost = 0.0;
    for (std::size_t t = 0; t < tracks_.size(); ++t) cost += LinearizeTrack(t);
    return cost;
  }

  double LinearizeTrack(std::size_t t) {
    const Track& track = tracks_[t];
    const Eigen::Vector3d point_in_map = state_.point_in_map[track.point];
    Eigen::Matrix3d point_block = Eigen::Matrix3d::Zero();
    Eigen::Vector3d point_gradient = Eigen::Vector3d::Zero();
    double cost = 0.0;
    for (int m = track.begin; m < track.end; ++m) {
      const Camera& camera = cameras_[measurements_[m].camera];
      const View view = LookAt(camera, measurements_[m], point_in_map);
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
  // positive definite in floating point.
  bool SolveStep(double damping) {
    StartReducedSystem(damping);
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      if (!tracks_[t].fixed) Eliminate(t, damping);
    }
    if (reduced_.size() > 0) {
      factor_.compute(reduced_.selfadjointView<Eigen::Lower>());
      if (factor_.info() != Eigen::Success) return false;
      step_.poses = -factor_.solve(reduced_gradient_);
    }
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      if (!tracks_[t].fixed) Substitute(t);
    }
    Predict(damping);
    return step_.poses.allFinite() && std::isfinite(step_.predicted_decrease);
  }

  void StartReducedSystem(double damping) {
    reduced_.setZero();
    for (std::size_t i = 0; i < free_poses_.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(6 * i);
      Matrix6d block = equations_.pose_block[i].selfadjointView<Eigen::Upper>();
      for (int k = 0; k < 6; ++k) block(k, k) += Damped(block(k, k), damping);
      reduced_.block<6, 6>(at, at) = block;
      reduced_gradient_.segment<6>(at) = equations_.pose_gradient[i];
    }
  }

  // Subtracts W V^-1 W' of one point from the lower triangle of the reduced system.
  void Eliminate(std::size_t t, double damping) {
    const Track& track = tracks_[t];
    Eigen::Matrix3d block = equations_.point_block[t];
    for (int k = 0; k < 3; ++k) block(k, k) += Damped(block(k, k), damping);
    inverse_[t] = block.inverse();
    for (int m = track.begin; m < track.free_end; ++m) {
      const Matrix63d product = equations_.mixed_block[m] * inverse_[t];
      const int row = 6 * VariableOf(m);
      reduced_gradient_.segment<6>(row).noalias() -= product * equations_.point_gradient[t];
      for (int n = track.begin; n <= m; ++n) {
        const int column = 6 * VariableOf(n);
        auto target = reduced_.block<6, 6>(row, column);
        target.noalias() -= product * equations_.mixed_block[n].transpose();
        // The same pose saw the point twice: both orders belong to its diagonal block.
        if (row == column && n != m) target.noalias() -= equations_.mixed_block[n] * product.transpose();
      }
    }
  }

  void Substitute(std::size_t t) {
    const Track& track = tracks_[t];
    Eigen::Vector3d right = equations_.point_gradient[t];
    for (int m = track.begin; m < track.free_end; ++m) {
      right.noalias() += equations_.mixed_block[m].transpose() * step_.poses.segment<6>(6 * VariableOf(m));
    }
    step_.points[t] = -(inverse_[t] * right);
  }

  // The decrease of the (doubled) cost by the quadratic model: step' (damping D step - gradient).
  void Predict(double damping) {
    double decrease = 0.0;
    for (std::size_t i = 0; i < free_poses_.size(); ++i) {
      const Vector6d step = step_.poses.segment<6>(static_cast<Eigen::Index>(6 * i));
      decrease -= step.dot(equations_.pose_gradient[i]);
      for (int k = 0; k < 6; ++k) decrease += Damped(equations_.pose_block[i](k, k), damping) * step(k) * step(k);
    }
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      if (tracks_[t].fixed) continue;
      const Eigen::Vector3d& step = step_.points[t];
      decrease -= step.dot(equations_.point_gradient[t]);
      for (int k = 0; k < 3; ++k) decrease += Damped(equations_.point_block[t](k, k), damping) * step(k) * step(k);
    }
    step_.predicted_decrease = decrease;
  }

  // Applies the step to the trial state; returns the trial's cost.
  double TrialCost() {
    for (std::size_t i = 0; i < free_poses_.size(); ++i) {
      const int pose = free_poses_[i];
      const Vector6d step = step_.poses.segment<6>(static_cast<Eigen::Index>(6 * i));
      trial_poses_[pose] = Rigid3d::Exp(step) * state_.camera_from_map[pose];
      trial_cameras_[pose].rotation = trial_poses_[pose].rotation().toRotationMatrix();
      trial_cameras_[pose].translation = trial_poses_[pose].translation();
    }
    double cost = 0.0;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      const Track& track = tracks_[t];
      Eigen::Vector3d& point_in_map = trial_points_[track.point];
      if (!track.fixed) point_in_map = state_.point_in_map[track.point] + step_.points[t];
      for (int m = track.begin; m < track.end; ++m) {
        const Measurement& measurement = measurements_[m];
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
    std::swap(cameras_, trial_cameras_);
  }

  int VariableOf(int measurement) const { return cameras_[measurements_[measurement].camera].variable; }

  const BundlePhase& phase_;
  BundleState& state_;
  std::vector<Camera> cameras_, trial_cameras_;  // per pose
  std::vector<Rigid3d> trial_poses_;
  std::vector<Eigen::Vector3d> trial_points_;
  std::vector<int> free_poses_;
  std::vector<Measurement> measurements_;
  std::vector<Track> tracks_;
  Equations equations_;
  Eigen::MatrixXd reduced_;
  Eigen::VectorXd reduced_gradient_;
  std::vector<Eigen::Matrix3d> inverse_;  // per track
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Step step_;
};

}  // namespace

PhaseOutcome RunLocalPhase(const BundlePhase& phase, BundleState& state) { return LocalBundle(phase, state).Run(); }

}  // namespace pangaea
