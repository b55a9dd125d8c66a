#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cstddef>
#include <optional>
#include <span>

#include "common/base/check.h"
#include "common/geometry/homography.h"

namespace pangaea::direct_linear {

using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Vector9d = Eigen::Matrix<double, 9, 1>;

// A 3 x 3 matrix between conditioned points, and what conditioned them.
struct Solution {
  Eigen::Matrix3d conditioned;
  Eigen::Matrix3d condition_first;
  Eigen::Matrix3d condition_second;
};

// The matrix, of norm 1, that best solves the linear equations of all pairs (direct linear transform with Hartley's
// conditioning). add(a, b, normal) adds the equations' squares of one conditioned pair (x, y, 1) to the normal matrix
// of the nine coefficients, row by row. Nothing for fewer than `minimal` pairs, and where a second solution is as good:
// the second eigenvalue is not above `min_gap` of the largest. The spans have equal lengths.
template <typename Add>
std::optional<Solution> Solve(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second,
                              std::size_t minimal, double min_gap, Add&& add) {
  PANGAEA_CHECK(first.size() == second.size());
  if (first.size() < minimal) return std::nullopt;
  const auto condition_first = ConditioningTransform(first);
  const auto condition_second = ConditioningTransform(second);
  if (!condition_first || !condition_second) return std::nullopt;
  Matrix9d normal = Matrix9d::Zero();
  for (std::size_t i = 0; i < first.size(); ++i) {
    add(Eigen::Vector3d(*condition_first * first[i].homogeneous()),
        Eigen::Vector3d(*condition_second * second[i].homogeneous()), normal);
  }
  const Eigen::SelfAdjointEigenSolver<Matrix9d> eigen(normal);
  if (!(eigen.eigenvalues()(1) > min_gap * eigen.eigenvalues()(8))) return std::nullopt;
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> conditioned(eigen.eigenvectors().col(0).data());
  return Solution{conditioned, *condition_first, *condition_second};
}

}  // namespace pangaea::direct_linear
