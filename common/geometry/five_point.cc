#include "common/geometry/five_point.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <array>
#include <cmath>

#include "common/base/check.h"

namespace pangaea {
namespace {

// Polynomials in x, y, z of degree up to 3 by their coefficients, in this order of monomials. The cubic ones come
// first: eliminating them leaves the last ten as a basis of what remains.
constexpr int kMonomials = 20;
constexpr int kCubic = 10;
struct Exponents {
  int x, y, z;
};
constexpr std::array<Exponents, kMonomials> kOrder{
    {{3, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 3, 0}, {2, 0, 1}, {1, 1, 1}, {0, 2, 1}, {1, 0, 2}, {0, 1, 2}, {0, 0, 3},
     {2, 0, 0}, {1, 1, 0}, {0, 2, 0}, {1, 0, 1}, {0, 1, 1}, {0, 0, 2}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}};
constexpr int kX = 16, kY = 17, kZ = 18, kOne = 19;

constexpr int IndexOf(const Exponents& wanted) {
  for (int i = 0; i < kMonomials; ++i) {
    if (kOrder[i].x == wanted.x && kOrder[i].y == wanted.y && kOrder[i].z == wanted.z) return i;
  }
  return -1;  // of a degree above 3
}

constexpr auto kProducts = [] {
  std::array<std::array<int, kMonomials>, kMonomials> table{};
  for (int i = 0; i < kMonomials; ++i) {
    for (int j = 0; j < kMonomials; ++j) {
      table[i][j] = IndexOf({kOrder[i].x + kOrder[j].x, kOrder[i].y + kOrder[j].y, kOrder[i].z + kOrder[j].z});
    }
  }
  return table;
}();

using Polynomial = Eigen::Matrix<double, 1, kMonomials>;
using PolynomialMatrix = std::array<std::array<Polynomial, 3>, 3>;
using Constraints = Eigen::Matrix<double, 10, kMonomials>;

// The degrees of a and b must not add to more than 3.
Polynomial Multiply(const Polynomial& a, const Polynomial& b) {
  Polynomial product = Polynomial::Zero();
  for (int i = 0; i < kMonomials; ++i) {
    if (a(i) == 0.0) continue;
    for (int j = kCubic; j < kMonomials; ++j) {
      if (kProducts[i][j] >= 0) product(kProducts[i][j]) += a(i) * b(j);
    }
  }
  return product;
}

// Rows: the four matrices that span what satisfies the epipolar constraints, row-major.
Eigen::Matrix<double, 4, 9> NullSpace(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second) {
  Eigen::Matrix<double, 9, 5> rows;
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d a = first[i].homogeneous();
    rows.col(i) << second[i].x() * a, second[i].y() * a, a;
  }
  const Eigen::HouseholderQR<Eigen::Matrix<double, 9, 5>> qr(rows);
  const Eigen::Matrix<double, 9, 9> orthogonal = qr.householderQ();
  return orthogonal.rightCols<4>().transpose();
}

// E = x X + y Y + z Z + W.
PolynomialMatrix GeneralMatrix(const Eigen::Matrix<double, 4, 9>& basis) {
  PolynomialMatrix matrix;
  for (int entry = 0; entry < 9; ++entry) {
    Polynomial& polynomial = matrix[entry / 3][entry % 3];
    polynomial.setZero();
    polynomial(kX) = basis(0, entry);
    polynomial(kY) = basis(1, entry);
    polynomial(kZ) = basis(2, entry);
    polynomial(kOne) = basis(3, entry);
  }
  return matrix;
}

// What makes a matrix an essential one: det E = 0 and 2 E E' E - trace(E E') E = 0.
Constraints EssentialConstraints(const PolynomialMatrix& e) {
  PolynomialMatrix square;  // E E'
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      square[i][j] = Multiply(e[i][0], e[j][0]) + Multiply(e[i][1], e[j][1]) + Multiply(e[i][2], e[j][2]);
      square[j][i] = square[i][j];
    }
  }
  const Polynomial half_trace = 0.5 * (square[0][0] + square[1][1] + square[2][2]);
  for (int i = 0; i < 3; ++i) square[i][i] -= half_trace;
  Constraints constraints;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      constraints.row(3 * i + j) =
          Multiply(square[i][0], e[0][j]) + Multiply(square[i][1], e[1][j]) + Multiply(square[i][2], e[2][j]);
    }
  }
  const auto minor = [&](int a, int b) { return Polynomial(Multiply(e[1][a], e[2][b]) - Multiply(e[1][b], e[2][a])); };
  constraints.row(9) = Multiply(minor(1, 2), e[0][0]) + Multiply(minor(2, 0), e[0][1]) + Multiply(minor(0, 1), e[0][2]);
  return constraints;
}

// Multiplication by x on the basis x2, xy, y2, xz, yz, z2, x, y, z, 1, once the cubic monomials are expressed by it.
Eigen::Matrix<double, 10, 10> ActionMatrix(const Eigen::Matrix<double, 10, 10>& cubic_by_basis) {
  Eigen::Matrix<double, 10, 10> action = Eigen::Matrix<double, 10, 10>::Zero();
  for (int row = 0; row < 10; ++row) {
    const int product = kProducts[kX][kCubic + row];
    if (product < kCubic) {
      action.row(row) = cubic_by_basis.row(product);
    } else {
      action(row, product - kCubic) = 1.0;
    }
  }
  return action;
}

}  // namespace

std::vector<Eigen::Matrix3d> SolveFivePoint(std::span<const Eigen::Vector2d> first,
                                            std::span<const Eigen::Vector2d> second) {
  PANGAEA_CHECK(first.size() == 5 && second.size() == 5);
  const Eigen::Matrix<double, 4, 9> basis = NullSpace(first, second);
  if (!basis.allFinite()) return {};
  const Constraints constraints = EssentialConstraints(GeneralMatrix(basis));
  const Eigen::FullPivLU<Eigen::Matrix<double, 10, 10>> cubic(constraints.leftCols<kCubic>());
  if (!cubic.isInvertible()) return {};
  const Eigen::Matrix<double, 10, 10> cubic_by_basis = -cubic.solve(constraints.rightCols<10>());
  const Eigen::EigenSolver<Eigen::Matrix<double, 10, 10>> eigen(ActionMatrix(cubic_by_basis));
  if (eigen.info() != Eigen::Success) return {};
  std::vector<Eigen::Matrix3d> solutions;
  for (int i = 0; i < 10; ++i) {
    if (std::abs(eigen.eigenvalues()(i).imag()) > 1e-9) continue;
    const Eigen::Matrix<double, 10, 1> monomials = eigen.eigenvectors().col(i).real();
    const Eigen::Vector4d weights = monomials.tail<4>() / monomials(9);
    const Eigen::Matrix<double, 1, 9> entries = weights.transpose() * basis;
    if (!entries.allFinite()) continue;
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> essential(entries.data());
    solutions.push_back(essential / essential.norm());
  }
  return solutions;
}

}  // namespace pangaea
