#include "common/estimation/pose_refinement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/check.h"
#include "common/estimation/pose_kernel.h"

namespace pangaea {
namespace {

// Levenberg-Marquardt damping, relative to the diagonal of the information.
constexpr double kInitialDamping = 1e-6;
constexpr double kDampingGrowth = 10.0;
constexpr double kDampingDecay = 0.1;
constexpr double kMaxDamping = 1e6;
// The smallest pivot of the information, scaled to a unit diagonal, of a pose that is determined.
constexpr double kMinPivot = 1e-9;
// Larger coordinates (map units, pixels, 1 / pixels) are garbage, and their squares would drown the others.
constexpr double kMaxMagnitude = 1e8;

bool IsUsable(const PoseObservation& observation) {
  const auto sane = [](double value) { return std::abs(value) < kMaxMagnitude; };  // false for NaN
  return sane(observation.point_in_map.x()) && sane(observation.point_in_map.y()) &&
         sane(observation.point_in_map.z()) && sane(observation.measurement.x()) && sane(observation.measurement.y()) &&
         sane(observation.measurement.z()) && sane(observation.inverse_sigma) && observation.inverse_sigma > 0.0;
}

bool IsDetermined(const Matrix6d& information) {
  const Vector6d diagonal = information.diagonal();
  if (!information.allFinite() || !(diagonal.array() > 0.0).all()) return false;
  const Vector6d scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Matrix6d> factor(scale.asDiagonal() * information * scale.asDiagonal());
  return factor.info() == Eigen::Success && factor.vectorD().minCoeff() > kMinPivot;
}

// The inverse of SE(3)'s left Jacobian at a twist: d Log(Exp(e) X) / de. The series of Bernoulli numbers is exact to
// double precision for the twists (well below 1) that a prior allows.
Matrix6d InverseLeftJacobian(const Vector6d& twist) {
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = Skew(twist.tail<3>());
  ad.topRightCorner<3, 3>() = Skew(twist.head<3>());
  const Matrix6d ad2 = ad * ad;
  const Matrix6d ad4 = ad2 * ad2;
  return Matrix6d::Identity() - ad / 2.0 + ad2 / 12.0 - ad4 / 720.0 + ad4 * ad2 / 30240.0;
}

void AddPrior(const PosePrior& prior, const Rigid3d& camera_from_map, PoseNormalEquations& equations) {
  const Vector6d error = (camera_from_map * prior.camera_from_map.Inverse()).Log();
  const Matrix6d jacobian = InverseLeftJacobian(error);
  const Eigen::Matrix<double, 6, 6> weighted = jacobian.transpose() * prior.information;
  equations.information += weighted * jacobian;
  equations.gradient += weighted * error;
  equations.cost += error.dot(prior.information * error);
}

class Refiner {
 public:
  Refiner(const IdealCamera& camera, const Rigid3d& initial, std::span<const PoseObservation> observations,
          const PoseRefinementOptions& options, std::span<std::uint8_t> inliers, const std::optional<PosePrior>& prior)
      : camera_(camera),
        observations_(observations),
        options_(options),
        inliers_(inliers),
        prior_(prior),
        wide_{options.monocular_chi2, options.stereo_chi2},
        narrow_(Narrowed(wide_, options.narrow_share)),
        camera_from_map_(initial) {}

  std::optional<RefinedPose> Run() {
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      // A point that starts behind the camera gives no usable direction of descent; it may come back when judged.
      const bool usable =
          IsUsable(observations_[i]) && (camera_from_map_ * observations_[i].point_in_map).z() > kMinDepth;
      inliers_[i] = usable ? 1 : 0;
    }
    int count = static_cast<int>(std::count(inliers_.begin(), inliers_.end(), std::uint8_t{1}));
    bool changed = true;
    bool converged = false;
    for (int round = 0; round < options_.rounds; ++round) {
      if (count < options_.min_inliers) return std::nullopt;
      const int first_narrow_round = options_.rounds - options_.rounds_with_narrow_kernel;
      if (!changed && round != first_narrow_round && converged) continue;
      converged = Optimize(round < first_narrow_round ? wide_ : narrow_);
      count = Judge(changed);
    }
    if (count < options_.min_inliers) return std::nullopt;
    return Report(count, converged);
  }

 private:
  PoseNormalEquations Linearize(const Rigid3d& camera_from_map, const KernelBends& bends) const {
    PoseNormalEquations equations = AccumulatePose(camera_, camera_from_map, observations_, inliers_, bends);
    if (prior_) AddPrior(*prior_, camera_from_map, equations);
    return equations;
  }

  // Moves the pose to the minimum over the current inliers. True when it got there.
  bool Optimize(const KernelBends& bends) {
    double damping = kInitialDamping;
    PoseNormalEquations equations = Linearize(camera_from_map_, bends);
    for (int i = 0; i < options_.max_iterations && damping < kMaxDamping; ++i) {
      Matrix6d damped = equations.information;
      damped.diagonal() *= 1.0 + damping;
      const Vector6d step = -damped.ldlt().solve(equations.gradient);
      if (!step.allFinite()) return false;
      const bool small = -step.dot(equations.gradient) < options_.step_tolerance * options_.step_tolerance;
      const Rigid3d trial = Rigid3d::Exp(step) * camera_from_map_;
      if (small) {
        camera_from_map_ = trial;
        return true;
      }
      const PoseNormalEquations next = Linearize(trial, bends);
      if (next.cost < equations.cost) {
        camera_from_map_ = trial;
        equations = next;
        damping *= kDampingDecay;
      } else {
        damping *= kDampingGrowth;
      }
    }
    return false;
  }

  // Sets every observation's flag by its squared residual at the current pose; returns the number of inliers.
  int Judge(bool& changed) {
    changed = false;
    int count = 0;
    squared_error_ = 0.0;
    const Eigen::Matrix3d rotation = camera_from_map_.rotation().toRotationMatrix();
    for (std::size_t i = 0; i < observations_.size(); ++i) {
      const PoseObservation& observation = observations_[i];
      if (!IsUsable(observation)) continue;
      const Eigen::Vector3d point_in_camera = rotation * observation.point_in_map + camera_from_map_.translation();
      Eigen::Vector3d measurement = observation.measurement;
      if (!camera_.is_stereo()) measurement.z() = -1.0;
      const double squared = observation.inverse_sigma * observation.inverse_sigma *
                             ReprojectionError(camera_, point_in_camera, measurement).squaredNorm();
      const double limit = IsStereo(measurement) ? options_.stereo_chi2 : options_.monocular_chi2;
      const std::uint8_t is_inlier = squared <= limit && point_in_camera.z() > kMinDepth ? 1 : 0;
      changed = changed || is_inlier != inliers_[i];
      inliers_[i] = is_inlier;
      count += is_inlier;
      if (is_inlier != 0) squared_error_ += squared;
    }
    return count;
  }

  std::optional<RefinedPose> Report(int count, bool converged) const {
    RefinedPose result;
    result.camera_from_map = camera_from_map_;
    result.inliers = count;
    result.information = Linearize(camera_from_map_, kNoKernel).information;
    result.mean_squared_error = squared_error_ / std::max(count, 1);
    result.converged = converged;
    if (!IsDetermined(result.information)) return std::nullopt;
    return result;
  }

  const IdealCamera& camera_;
  std::span<const PoseObservation> observations_;
  const PoseRefinementOptions& options_;
  std::span<std::uint8_t> inliers_;
  const std::optional<PosePrior>& prior_;
  const KernelBends wide_;
  const KernelBends narrow_;
  Rigid3d camera_from_map_;
  double squared_error_ = 0.0;
};

}  // namespace

Status PoseRefinementOptions::Check() const {
  if (!(monocular_chi2 > 0.0) || !(stereo_chi2 > 0.0)) {
    return Fail(ErrorCode::kInvalidArgument, "pose refinement: chi2 thresholds must be > 0");
  }
  if (rounds < 1 || rounds_with_narrow_kernel < 0 || rounds_with_narrow_kernel > rounds || max_iterations < 1) {
    return Fail(ErrorCode::kInvalidArgument,
                "pose refinement: rounds and max_iterations must be >= 1, rounds_with_narrow_kernel in [0, rounds]");
  }
  if (!(narrow_share >= kLeastShare)) {
    return Fail(ErrorCode::kInvalidArgument, "pose refinement: narrow_share must be >= 1e-6");
  }
  if (!(step_tolerance >= 0.0) || min_inliers < 0) {
    return Fail(ErrorCode::kInvalidArgument, "pose refinement: step_tolerance and min_inliers must be >= 0");
  }
  return {};
}

std::optional<RefinedPose> RefinePose(const IdealCamera& camera, const Rigid3d& initial_camera_from_map,
                                      std::span<const PoseObservation> observations,
                                      const PoseRefinementOptions& options, std::span<std::uint8_t> inliers,
                                      const std::optional<PosePrior>& prior) {
  PANGAEA_CHECK(inliers.size() == observations.size());
  std::optional<RefinedPose> pose;
  if (initial_camera_from_map.AllFinite()) {
    pose = Refiner(camera, initial_camera_from_map, observations, options, inliers, prior).Run();
  }
  if (!pose) std::fill(inliers.begin(), inliers.end(), std::uint8_t{0});
  return pose;
}

Eigen::Vector3d TranslationSigmas(const Matrix6d& information) {
  if (!IsDetermined(information)) return Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  const Matrix6d covariance = information.ldlt().solve(Matrix6d::Identity());
  return covariance.diagonal().head<3>().cwiseSqrt();
}

}  // namespace pangaea
