#include "common/geometry/essential_matrix.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "common/base/check.h"
#include "common/geometry/homography.h"

namespace pangaea {
namespace {

constexpr std::size_t kMinimalPoints = 8;

using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Vector9d = Eigen::Matrix<double, 9, 1>;

// The nearest matrix with singular values 1, 1, 0.
Eigen::Matrix3d MakeEssential(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * Eigen::Vector3d(1.0, 1.0, 0.0).asDiagonal() * svd.matrixV().transpose();
}

}  // namespace

std::optional<Eigen::Matrix3d> FitEssentialMatrix(std::span<const Eigen::Vector2d> first,
                                                  std::span<const Eigen::Vector2d> second) {
  PANGAEA_CHECK(first.size() == second.size());
  if (first.size() < kMinimalPoints) return std::nullopt;
  const auto condition_first = ConditioningTransform(first);
  const auto condition_second = ConditioningTransform(second);
  if (!condition_first || !condition_second) return std::nullopt;
  Matrix9d normal = Matrix9d::Zero();
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Eigen::Vector3d a = *condition_first * first[i].homogeneous();
    const Eigen::Vector3d b = *condition_second * second[i].homogeneous();
    Vector9d row;
    row << b.x() * a, b.y() * a, a;
    normal += row * row.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix9d> eigen(normal);
  if (!(eigen.eigenvalues()(1) > 1e-12 * eigen.eigenvalues()(8))) return std::nullopt;
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> conditioned(eigen.eigenvectors().col(0).data());
  const Eigen::Matrix3d matrix = condition_second->transpose() * conditioned * *condition_first;
  if (!matrix.allFinite()) return std::nullopt;
  return MakeEssential(matrix);
}

Eigen::Matrix3d EssentialMatrixOf(const Rigid3d& second_from_first) {
  return Skew(second_from_first.translation()) * second_from_first.rotation().toRotationMatrix();
}

std::vector<Rigid3d> DecomposeEssentialMatrix(const Eigen::Matrix3d& essential) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(essential, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d quarter_turn;
  quarter_turn << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  const Eigen::Vector3d translation = svd.matrixU().col(2);
  std::vector<Rigid3d> motions;
  for (const Eigen::Matrix3d& turn : {quarter_turn, Eigen::Matrix3d(quarter_turn.transpose())}) {
    Eigen::Matrix3d rotation = svd.matrixU() * turn * svd.matrixV().transpose();
    if (rotation.determinant() < 0.0) rotation = -rotation;
    for (const double sign : {1.0, -1.0}) motions.emplace_back(Eigen::Quaterniond(rotation), sign * translation);
  }
  return motions;
}

}  // namespace pangaea
