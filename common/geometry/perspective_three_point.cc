#include "common/geometry/perspective_three_point.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace pangaea {
namespace {

// Sine of the points' smallest usable angle: below it they are collinear and any rotation about their line will do.
constexpr double kMinTriangleSine = 1e-4;
// Newton steps on the distances; they converge quadratically and start near the solution.
constexpr int kDistanceIterations = 5;
// Of a matrix of unit norm.
constexpr double kVanishingDeterminant = 1e-13;
// Largest relative error of a squared distance for a solution to be real.
constexpr double kMaxRelativeError = 1e-6;

// The quadratic forms of the law of cosines: with distances d = (d0, d1, d2), d' form[k] d = squared_length[k] for the
// pairs k = 01, 02, 12 (Eq. 3 of Persson and Nordberg).
struct LawOfCosines {
  std::array<Eigen::Matrix3d, 3> form;
  std::array<double, 3> squared_length;
};

constexpr std::array<std::pair<int, int>, 3> kPairs = {{{0, 1}, {0, 2}, {1, 2}}};

LawOfCosines MakeLawOfCosines(const std::array<Eigen::Vector3d, 3>& bearings,
                              const std::array<Eigen::Vector3d, 3>& points) {
  LawOfCosines law;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [i, j] = kPairs[k];
    law.form[k].setZero();
    law.form[k](i, i) = law.form[k](j, j) = 1.0;
    law.form[k](i, j) = law.form[k](j, i) = -bearings[i].dot(bearings[j]);
    law.squared_length[k] = (points[i] - points[j]).squaredNorm();
  }
  return law;
}

Eigen::Matrix3d Adjugate(const Eigen::Matrix3d& m) {
  Eigen::Matrix3d cofactors;
  cofactors.col(0) = m.col(1).cross(m.col(2));
  cofactors.col(1) = m.col(2).cross(m.col(0));
  cofactors.col(2) = m.col(0).cross(m.col(1));
  return cofactors.transpose();
}

// One real root of x^3 + b x^2 + c x + d, the one where the slope is steepest: its neighbourhood is best conditioned.
double CubicRoot(double b, double c, double d) {
  const double shift = b / 3.0;
  const double p = c - b * shift;
  const double q = (2.0 * shift * shift - c) * shift + d;
  // Depressed: y^3 + p y + q = 0.
  const double discriminant = 0.25 * q * q + p * p * p / 27.0;
  double y = 0.0;
  if (discriminant >= 0.0) {
    const double larger = std::cbrt(std::abs(0.5 * q) + std::sqrt(discriminant));
    y = larger > 0.0 ? (larger - p / (3.0 * larger)) * (q > 0.0 ? -1.0 : 1.0) : 0.0;
  } else {
    const double radius = 2.0 * std::sqrt(-p / 3.0);
    const double angle = std::acos(std::clamp(3.0 * q / (p * radius), -1.0, 1.0)) / 3.0;
    // The outer roots are never double ones together; of the two take that with the larger magnitude.
    y = q > 0.0 ? radius * std::cos(angle + 2.0 * M_PI / 3.0) : radius * std::cos(angle);
  }
  double x = y - shift;
  for (int i = 0; i < 2; ++i) {
    const double slope = (3.0 * x + 2.0 * b) * x + c;
    if (slope == 0.0) break;
    x -= (((x + b) * x + c) * x + d) / slope;
  }
  return x;
}

// The matrix d1 + x d2 of determinant zero. |det d1| <= |det d2|; where even that vanishes, as in symmetric scenes, d1
// is the one already.
std::optional<Eigen::Matrix3d> DegenerateMember(const Eigen::Matrix3d& d1, const Eigen::Matrix3d& d2) {
  const double leading = d2.determinant();
  if (std::abs(leading) <= kVanishingDeterminant * std::pow(d2.norm(), 3)) return d1;
  const double inverse = 1.0 / leading;
  const double root = CubicRoot((Adjugate(d2) * d1).trace() * inverse, (Adjugate(d1) * d2).trace() * inverse,
                                d1.determinant() * inverse);
  if (!std::isfinite(root)) return std::nullopt;
  return d1 + root * d2;
}

// Newton's method on the three distances, in place. False when it does not arrive.
bool RefineDistances(const LawOfCosines& law, Eigen::Vector3d& distances) {
  double error = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kDistanceIterations; ++i) {
    Eigen::Vector3d residual;
    Eigen::Matrix3d jacobian;
    error = 0.0;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d product = law.form[k] * distances;
      residual(k) = distances.dot(product) - law.squared_length[k];
      jacobian.row(k) = 2.0 * product;
      error = std::max(error, std::abs(residual(k)) / law.squared_length[k]);
    }
    if (i == kDistanceIterations || error < std::numeric_limits<double>::epsilon()) break;
    distances -= Adjugate(jacobian) * residual / jacobian.determinant();
  }
  return error < kMaxRelativeError && (distances.array() > 0.0).all();
}

Rigid3d PoseFromDistances(const std::array<Eigen::Vector3d, 3>& bearings, const std::array<Eigen::Vector3d, 3>& points,
                          const Eigen::Vector3d& distances) {
  std::array<Eigen::Vector3d, 3> in_camera;
  for (int i = 0; i < 3; ++i) in_camera[i] = distances(i) * bearings[i];
  const auto frame = [](const std::array<Eigen::Vector3d, 3>& p) {
    Eigen::Matrix3d axes;
    axes.col(0) = (p[1] - p[0]).normalized();
    axes.col(2) = axes.col(0).cross(p[2] - p[0]).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    return axes;
  };
  const Eigen::Quaterniond rotation(frame(in_camera) * frame(points).transpose());
  const Eigen::Vector3d center = (points[0] + points[1] + points[2]) / 3.0;
  const Eigen::Vector3d center_in_camera = (in_camera[0] + in_camera[1] + in_camera[2]) / 3.0;
  return Rigid3d(rotation, center_in_camera - rotation.normalized() * center);
}

class Solver {
 public:
  Solver(const std::array<Eigen::Vector3d, 3>& bearings, const std::array<Eigen::Vector3d, 3>& points)
      : bearings_(bearings), points_(points), law_(MakeLawOfCosines(bearings, points)) {}

  ThreePointPoses Solve() {
    // Two homogeneous equations d' D1 d = d' D2 d = 0; D1 + root * D2 is degenerate, a pair of planes (Eqs. 4 to 7).
    Eigen::Matrix3d d1 = law_.form[0] * law_.squared_length[2] - law_.form[2] * law_.squared_length[0];
    Eigen::Matrix3d d2 = law_.form[1] * law_.squared_length[2] - law_.form[2] * law_.squared_length[1];
    if (std::abs(d1.determinant()) > std::abs(d2.determinant())) std::swap(d1, d2);
    const std::optional<Eigen::Matrix3d> member = DegenerateMember(d1, d2);
    if (!member) return poses_;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(*member);
    // Ascending: the eigenvalue near zero lies between one negative and one positive.
    const double negative = eigen.eigenvalues()(0);
    const double positive = eigen.eigenvalues()(2);
    if (!(negative < 0.0) || !(positive > 0.0)) return poses_;
    const Eigen::Vector3d a = std::sqrt(positive) * eigen.eigenvectors().col(2);
    const Eigen::Vector3d b = std::sqrt(-negative) * eigen.eigenvectors().col(0);
    IntersectPlane(a + b, d2);
    IntersectPlane(a - b, d2);
    return poses_;
  }

 private:
  // The distances in the plane normal' d = 0 that satisfy d' form d = 0: a quadratic in the ratio of two of them.
  void IntersectPlane(const Eigen::Vector3d& normal, const Eigen::Matrix3d& form) {
    int pivot = 0;
    normal.cwiseAbs().maxCoeff(&pivot);
    const int first = (pivot + 1) % 3;
    const int second = (pivot + 2) % 3;
    Eigen::Vector3d base = Eigen::Vector3d::Zero();
    Eigen::Vector3d slope = Eigen::Vector3d::Zero();
    base(first) = 1.0;
    base(pivot) = -normal(first) / normal(pivot);
    slope(second) = 1.0;
    slope(pivot) = -normal(second) / normal(pivot);
    const double a = slope.dot(form * slope);
    const double half_b = base.dot(form * slope);
    const double c = base.dot(form * base);
    const double discriminant = half_b * half_b - a * c;
    if (!(discriminant >= 0.0)) return;
    const double q = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
    Accept(base + q / a * slope);
    if (q != 0.0 && discriminant > 0.0) Accept(base + c / q * slope);
  }

  void Accept(Eigen::Vector3d direction) {
    if (!direction.allFinite() || !(direction.array() > 0.0).all() || poses_.count == 4) return;
    const double squared = direction.dot(law_.form[2] * direction);
    if (!(squared > 0.0)) return;
    Eigen::Vector3d distances = direction * std::sqrt(law_.squared_length[2] / squared);
    if (!RefineDistances(law_, distances)) return;
    poses_.camera_from_map[poses_.count++] = PoseFromDistances(bearings_, points_, distances);
  }

  const std::array<Eigen::Vector3d, 3>& bearings_;
  const std::array<Eigen::Vector3d, 3>& points_;
  LawOfCosines law_;
  ThreePointPoses poses_;
};

}  // namespace

ThreePointPoses SolvePerspectiveThreePoint(const std::array<Eigen::Vector3d, 3>& bearings,
                                           const std::array<Eigen::Vector3d, 3>& points_in_map) {
  const Eigen::Vector3d side_a = points_in_map[1] - points_in_map[0];
  const Eigen::Vector3d side_b = points_in_map[2] - points_in_map[0];
  const double doubled_area = side_a.cross(side_b).norm();
  const double longest = std::max({side_a.squaredNorm(), side_b.squaredNorm(), (side_a - side_b).squaredNorm()});
  if (!(doubled_area > kMinTriangleSine * longest)) return {};
  return Solver(bearings, points_in_map).Solve();
}

}  // namespace pangaea
