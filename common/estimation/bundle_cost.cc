#include "common/estimation/bundle_cost.h"

#include <ceres/sized_cost_function.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace pangaea {
namespace {

template <int kResiduals>
class BundleCost final : public ceres::SizedCostFunction<kResiduals, 7, 3> {
 public:
  BundleCost(const IdealCamera& camera, const Eigen::Vector3d& measurement, double inverse_sigma)
      : camera_(camera), measurement_(measurement), inverse_sigma_(inverse_sigma) {}

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> rotation(parameters[0]);
    const Eigen::Map<const Eigen::Vector3d> translation(parameters[0] + 4);
    const Eigen::Map<const Eigen::Vector3d> point_in_map(parameters[1]);
    const Eigen::Matrix3d rotation_matrix = rotation.toRotationMatrix();
    const Eigen::Vector3d point_in_camera = rotation_matrix * point_in_map + translation;
    const Eigen::Vector3d error = ReprojectionError(camera_, point_in_camera, measurement_);
    Eigen::Map<Eigen::Matrix<double, kResiduals, 1>> residual(residuals);
    residual = inverse_sigma_ * error.head<kResiduals>();
    if (jacobians == nullptr) return true;

    const Eigen::Matrix<double, kResiduals, 3> by_point =
        inverse_sigma_ * ReprojectionJacobian(camera_, point_in_camera, kResiduals == 3).template topRows<kResiduals>();
    if (jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, kResiduals, 7, Eigen::RowMajor>> by_pose(jacobians[0]);
      by_pose.template leftCols<6>() = by_point * PerturbationJacobian(point_in_camera);
      by_pose.template rightCols<1>().setZero();
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, kResiduals, 3, Eigen::RowMajor>> by_point_in_map(jacobians[1]);
      by_point_in_map = by_point * rotation_matrix;
    }
    return true;
  }

 private:
  // Copied: a cost function may outlive the problem it was made from.
  const IdealCamera camera_;
  const Eigen::Vector3d measurement_;
  const double inverse_sigma_;
};

using Jacobian76 = Eigen::Matrix<double, 7, 6, Eigen::RowMajor>;
using Jacobian67 = Eigen::Matrix<double, 6, 7, Eigen::RowMajor>;

Rigid3d FromPointer(const double* x) {
  return Rigid3d(Eigen::Quaterniond(x[3], x[0], x[1], x[2]), Eigen::Vector3d(x[4], x[5], x[6]));
}

}  // namespace

PoseParameters ToParameters(const Rigid3d& pose) {
  const Eigen::Quaterniond& q = pose.rotation();
  const Eigen::Vector3d& t = pose.translation();
  return {q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()};
}

Rigid3d ToRigid(const PoseParameters& parameters) { return FromPointer(parameters.data()); }

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Rigid3d sum = Rigid3d::Exp(Eigen::Map<const Vector6d>(delta)) * FromPointer(x);
  const PoseParameters parameters = ToParameters(sum);
  std::copy(parameters.begin(), parameters.end(), x_plus_delta);
  return true;
}

bool PoseManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Jacobian76>(jacobian).setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Vector6d> difference(y_minus_x);
  difference = (FromPointer(y) * FromPointer(x).Inverse()).Log();
  return true;
}

bool PoseManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Jacobian67>(jacobian).setIdentity();
  return true;
}

std::unique_ptr<ceres::CostFunction> MakeBundleCost(const IdealCamera& camera, const BundleObservation& observation) {
  if (IsStereo(observation.measurement)) {
    return std::make_unique<BundleCost<3>>(camera, observation.measurement, observation.inverse_sigma);
  }
  return std::make_unique<BundleCost<2>>(camera, observation.measurement, observation.inverse_sigma);
}

}  // namespace pangaea
