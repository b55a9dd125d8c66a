#include "common/geometry/essential_matrix.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include "common/geometry/direct_linear.h"

namespace pangaea {
namespace {

constexpr std::size_t kMinimalPoints = 8;

// The nearest matrix with singular values 1, 1, 0.
Eigen::Matrix3d MakeEssential(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * Eigen::Vector3d(1.0, 1.0, 0.0).asDiagonal() * svd.matrixV().transpose();
}

}  // namespace

std::optional<Eigen::Matrix3d> FitEssentialMatrix(std::span<const Eigen::Vector2d> first,
                                                  std::span<const Eigen::Vector2d> second) {
  const auto add = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b, direct_linear::Matrix9d& normal) {
    direct_linear::Vector9d row;
    row << b.x() * a, b.y() * a, a;
    normal += row * row.transpose();
  };
  const auto solution = direct_linear::Solve(first, second, kMinimalPoints, 1e-12, add);
  if (!solution) return std::nullopt;
  const Eigen::Matrix3d matrix =
      solution->condition_second.transpose() * solution->conditioned * solution->condition_first;
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
