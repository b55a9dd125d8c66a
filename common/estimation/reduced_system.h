#pragma once

#include <Eigen/Cholesky>
#include <Eigen/CholmodSupport>
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "common/estimation/local_bundle_layout.h"
#include "common/geometry/rigid3.h"

// The reduced camera system S x = g of bundle adjustment, symmetric positive definite, in blocks of 6 x 6 by free pose.
// Both kinds have the same functions; only blocks with row >= column exist, and of those on the diagonal the upper
// triangle is not read.

namespace pangaea::local_bundle {

// For few poses, most of which see the same points.
class DenseReducedSystem {
 public:
  static constexpr bool kStepsAreLong = false;  // milliseconds, and the caller gets the best state after a whole one
  explicit DenseReducedSystem(const Layout& layout);

  void SetZero() { matrix_.setZero(); }
  auto Block(int row, int column) { return matrix_.block<6, 6>(6 * row, 6 * column); }
  // False where the matrix is not positive definite in floating point.
  bool Factorize();
  Eigen::VectorXd Solve(const Eigen::VectorXd& right) const { return factor_.solve(right); }

 private:
  Eigen::MatrixXd matrix_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

// For many poses, of which each shares points with some. Holds the blocks of poses that share a point.
class SparseReducedSystem {
 public:
  static constexpr bool kStepsAreLong = true;
  explicit SparseReducedSystem(const Layout& layout);

  void SetZero();
  Matrix6d& Block(int row, int column);
  bool Factorize();
  Eigen::VectorXd Solve(const Eigen::VectorXd& right) const { return factor_.solve(right); }

 private:
  void MakePattern();
  void CopyValues();

  std::vector<std::vector<int>> columns_;  // of each row's blocks, ascending, the diagonal last
  std::vector<int> first_block_;           // of each row
  std::vector<Matrix6d> blocks_;
  std::vector<std::vector<std::pair<int, int>>> column_blocks_;  // row and block, ascending, for each column
  Eigen::SparseMatrix<double> matrix_;                           // lower triangle
  Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor_;
};

}  // namespace pangaea::local_bundle
