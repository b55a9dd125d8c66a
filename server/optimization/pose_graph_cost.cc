#include "server/optimization/pose_graph_cost.h"

#include <ceres/sized_cost_function.h>

#include <algorithm>
#include <cmath>

namespace pangaea {
namespace {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

// The inverse of the left Jacobian of SO(3): Log(Exp(w) Exp(phi)) = phi + InverseLeftJacobian(phi) w + O(w^2).
Eigen::Matrix3d InverseLeftJacobian(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d skew = Skew(phi);
  double factor = 1.0 / 12.0;
  // Below, the fraction loses all digits and its next term is of no account.
  if (angle > 1e-3) factor = 1.0 / (angle * angle) - (1.0 + std::cos(angle)) / (2.0 * angle * std::sin(angle));
  return Eigen::Matrix3d::Identity() - 0.5 * skew + factor * skew * skew;
}

template <int kResiduals>
class PoseGraphCost final : public ceres::SizedCostFunction<kResiduals, 8, 8> {
 public:
  PoseGraphCost(const Similarity3d& to_from_from, const PoseGraphWeights& weights) : to_from_from_(to_from_from) {
    weights_.head<3>().setConstant(weights.translation);
    weights_.segment<3>(3).setConstant(weights.rotation);
    weights_[6] = weights.scale;
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const Similarity3d from_from_to = ToSimilarity(parameters[0]) * ToSimilarity(parameters[1]).Inverse();
    const Similarity3d error = to_from_from_ * from_from_to;
    const Eigen::Vector3d rotation = LogSo3(error.rotation());
    Vector7d residual;
    residual << error.translation(), rotation, std::log(error.scale());
    residual = residual.cwiseProduct(weights_);
    std::copy_n(residual.data(), kResiduals, residuals);
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) Write(ByFrom(from_from_to, rotation), jacobians[0]);
    if (jacobians[1] != nullptr) Write(ByTo(error, rotation), jacobians[1]);
    return true;
  }

 private:
  // E(e) y = measured * (y + l y + w x y + v) of y = from_from_to * x, to first order.
  Matrix7d ByFrom(const Similarity3d& from_from_to, const Eigen::Vector3d& rotation) const {
    const Eigen::Matrix3d turn = to_from_from_.rotation().toRotationMatrix();
    const Eigen::Matrix3d stretch = to_from_from_.scale() * turn;
    Matrix7d jacobian = Matrix7d::Zero();
    jacobian.block<3, 3>(0, 0) = stretch;
    jacobian.block<3, 3>(0, 3) = -stretch * Skew(from_from_to.translation());
    jacobian.block<3, 1>(0, 6) = stretch * from_from_to.translation();
    jacobian.block<3, 3>(3, 3) = InverseLeftJacobian(rotation) * turn;
    jacobian(6, 6) = 1.0;
    return jacobian;
  }

  // E(e) x = error * (x - l x - w x x - v), to first order.
  static Matrix7d ByTo(const Similarity3d& error, const Eigen::Vector3d& rotation) {
    Matrix7d jacobian = Matrix7d::Zero();
    jacobian.block<3, 3>(0, 0) = -error.scale() * error.rotation().toRotationMatrix();
    jacobian.block<3, 3>(3, 3) = -InverseLeftJacobian(-rotation);
    jacobian(6, 6) = -1.0;
    return jacobian;
  }

  void Write(const Matrix7d& jacobian, double* output) const {
    Eigen::Map<Eigen::Matrix<double, kResiduals, 8, Eigen::RowMajor>> written(output);
    written.template leftCols<7>() = (weights_.asDiagonal() * jacobian).template topRows<kResiduals>();
    written.template rightCols<1>().setZero();
  }

  const Similarity3d to_from_from_;
  Vector7d weights_;
};

void SetIdentity(double* jacobian, int rows, int columns) {
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(jacobian, rows, columns)
      .setIdentity();
}

}  // namespace

std::unique_ptr<ceres::CostFunction> MakePoseGraphCost(const Similarity3d& to_from_from,
                                                       const PoseGraphWeights& weights, bool with_scale) {
  if (with_scale) return std::make_unique<PoseGraphCost<7>>(to_from_from, weights);
  return std::make_unique<PoseGraphCost<6>>(to_from_from, weights);
}

SimilarityParameters ToParameters(const Similarity3d& similarity) {
  const Eigen::Quaterniond& q = similarity.rotation();
  const Eigen::Vector3d& t = similarity.translation();
  return {q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z(), std::log(similarity.scale())};
}

Similarity3d ToSimilarity(const double* x) {
  return Similarity3d(std::exp(x[7]), Eigen::Quaterniond(x[3], x[0], x[1], x[2]), Eigen::Vector3d(x[4], x[5], x[6]));
}

bool SimilarityManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const double scale = tangent_ == 7 ? std::exp(delta[6]) : 1.0;
  const Similarity3d step(scale, ExpSo3(Eigen::Map<const Eigen::Vector3d>(delta + 3)),
                          Eigen::Map<const Eigen::Vector3d>(delta));
  SimilarityParameters sum = ToParameters(step * ToSimilarity(x));
  if (tangent_ == 6) sum[7] = x[7];
  std::ranges::copy(sum, x_plus_delta);
  return true;
}

bool SimilarityManifold::PlusJacobian(const double*, double* jacobian) const {
  SetIdentity(jacobian, 8, tangent_);
  return true;
}

bool SimilarityManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  const Similarity3d step = ToSimilarity(y) * ToSimilarity(x).Inverse();
  Vector7d difference;
  difference << step.translation(), LogSo3(step.rotation()), std::log(step.scale());
  std::copy_n(difference.data(), tangent_, y_minus_x);
  return true;
}

bool SimilarityManifold::MinusJacobian(const double*, double* jacobian) const {
  SetIdentity(jacobian, tangent_, 8);
  return true;
}

}  // namespace pangaea
