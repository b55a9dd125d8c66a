#include "common/estimation/similarity_kernel.h"

#include <cmath>

namespace pangaea {
namespace {

using PointJacobian = Eigen::Matrix<double, 3, 7>;  // of a point by the perturbation

// Adds the error of `point` (in the sighting's side) where the sighting was made.
void AddSighting(const Sighting& sighting, const Eigen::Vector3d& point, const PointJacobian& point_by_e, double bend,
                 SimilarityNormalEquations& equations) {
  const Eigen::Matrix3d rotation = sighting.camera_from_side.rotation().toRotationMatrix();
  const Eigen::Vector3d point_in_camera = rotation * point + sighting.camera_from_side.translation();
  const Eigen::Vector3d error = ReprojectionError(sighting.camera, point_in_camera, sighting.measurement);
  const bool stereo = IsStereo(sighting.measurement);
  const PointJacobian jacobian =
      ReprojectionJacobian(sighting.camera, point_in_camera, stereo) * (rotation * point_by_e);
  const double squared_weight = sighting.inverse_sigma * sighting.inverse_sigma;
  const double squared = squared_weight * error.squaredNorm();
  const double root = squared > bend ? std::sqrt(bend / squared) : 1.0;
  equations.cost += squared > bend ? 2.0 * root * squared - bend : squared;
  equations.gradient.noalias() += (squared_weight * root) * (jacobian.transpose() * error);
  equations.information.noalias() += (squared_weight * root) * (jacobian.transpose() * jacobian);
}

}  // namespace

SimilarityNormalEquations AccumulateSimilarity(std::span<const SightingPair> pairs,
                                               std::span<const std::uint8_t> active,
                                               const Similarity3d& target_from_source, double monocular_bend,
                                               double stereo_bend) {
  const Similarity3d source_from_target = target_from_source.Inverse();
  const Eigen::Matrix3d inverse_linear = source_from_target.scale() * source_from_target.rotation().toRotationMatrix();
  const auto bend_of = [&](const Sighting& s) { return IsStereo(s.measurement) ? stereo_bend : monocular_bend; };
  SimilarityNormalEquations equations;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (active[i] == 0) continue;
    const SightingPair& pair = pairs[i];
    // d(Perturb(e, S) p) / de = (I, -[S p]x, S p) at e = 0.
    const Eigen::Vector3d in_target = target_from_source * pair.source.point;
    PointJacobian by_e;
    by_e << Eigen::Matrix3d::Identity(), -Skew(in_target), in_target;
    AddSighting(pair.target, in_target, by_e, bend_of(pair.target), equations);
    // Perturb(e, S)^-1 q = S^-1 (Perturb(e, 1)^-1 q), whose derivative is that of the linear part of S^-1 times
    // -(I, -[q]x, q).
    by_e << -Eigen::Matrix3d::Identity(), Skew(pair.target.point), -pair.target.point;
    by_e = (inverse_linear * by_e).eval();
    AddSighting(pair.source, source_from_target * pair.target.point, by_e, bend_of(pair.source), equations);
  }
  return equations;
}

}  // namespace pangaea
