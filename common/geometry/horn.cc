#include "common/geometry/horn.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "common/base/check.h"

namespace pangaea {
namespace {

// The rotation is undetermined when the two largest eigenvalues meet; their gap is compared with the spread of the
// points. 1e-6 is a line of points with a thousandth of its length as width.
constexpr double kMinRelativeGap = 1e-6;

Eigen::Vector3d Centroid(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

// The symmetric matrix whose largest eigenvector is the rotation's quaternion (w, x, y, z), from the correlation
// sum source * target' (Horn 1987, section 4.A).
Eigen::Matrix4d QuaternionForm(const Eigen::Matrix3d& s) {
  Eigen::Matrix4d form;
  form << s.trace(), s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0),  //
      0.0, s(0, 0) - s(1, 1) - s(2, 2), s(0, 1) + s(1, 0), s(2, 0) + s(0, 2),  //
      0.0, 0.0, -s(0, 0) + s(1, 1) - s(2, 2), s(1, 2) + s(2, 1),               //
      0.0, 0.0, 0.0, -s(0, 0) - s(1, 1) + s(2, 2);
  return form.selfadjointView<Eigen::Upper>();
}

}  // namespace

std::optional<Similarity3d> AlignPoints(std::span<const Eigen::Vector3d> target,
                                        std::span<const Eigen::Vector3d> source, bool with_scale) {
  PANGAEA_CHECK(target.size() == source.size());
  if (source.size() < 3) return std::nullopt;
  const Eigen::Vector3d target_center = Centroid(target);
  const Eigen::Vector3d source_center = Centroid(source);
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  double target_spread = 0.0;
  double source_spread = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3d t = target[i] - target_center;
    const Eigen::Vector3d s = source[i] - source_center;
    correlation += s * t.transpose();
    target_spread += t.squaredNorm();
    source_spread += s.squaredNorm();
  }
  const double spread = std::sqrt(target_spread * source_spread);
  if (!correlation.allFinite() || !std::isfinite(spread) || spread <= 0.0) return std::nullopt;

  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(QuaternionForm(correlation / spread));
  if (eigen.eigenvalues()(3) - eigen.eigenvalues()(2) < kMinRelativeGap) return std::nullopt;
  const Eigen::Vector4d q = eigen.eigenvectors().col(3);
  const Eigen::Quaterniond rotation(q(0), q(1), q(2), q(3));
  // At the optimum sum target . (R source) is the largest eigenvalue.
  const double scale = with_scale ? eigen.eigenvalues()(3) * spread / source_spread : 1.0;
  if (!(scale > 0.0)) return std::nullopt;
  return Similarity3d(scale, rotation, target_center - scale * (rotation * source_center));
}

}  // namespace pangaea
