#pragma once

#include <ceres/cost_function.h>
#include <ceres/manifold.h>

#include <array>
#include <memory>

#include "common/geometry/similarity3.h"

namespace pangaea {

// A camera with a scale, camera_from_map in Sim(3), as Ceres sees it: quaternion x, y, z, w, translation, logarithm of
// the scale.
using SimilarityParameters = std::array<double, 8>;
SimilarityParameters ToParameters(const Similarity3d& similarity);
Similarity3d ToSimilarity(const double* parameters);

// x plus e, e = (translation v, rotation w, logarithm of the scale l), is the similarity y -> exp(l) Exp(w) y + v after
// x. Without a free scale, l is 0 and left out. As on PoseManifold, cost functions write their derivative by e into the
// first columns, and PlusJacobian is (I; 0) by intent.
class SimilarityManifold final : public ceres::Manifold {
 public:
  explicit SimilarityManifold(bool scale_is_free) : tangent_(scale_is_free ? 7 : 6) {}
  int AmbientSize() const override { return 8; }
  int TangentSize() const override { return tangent_; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

 private:
  const int tangent_;
};

struct PoseGraphWeights {
  double translation = 1.0;  // 1 / map units
  double rotation = 1.0;     // 1 / radians
  double scale = 1.0;        // 1 / logarithm of the scale
};

// How far two cameras S_from, S_to (parameter blocks in this order) are from a measured motion: with
// E = to_from_from * S_from * S_to^-1, the weighted translation, rotation vector and, `with_scale`, logarithm of the
// scale of E: 6 or 7 residuals. E is the identity where they fit.
std::unique_ptr<ceres::CostFunction> MakePoseGraphCost(const Similarity3d& to_from_from,
                                                       const PoseGraphWeights& weights, bool with_scale);

}  // namespace pangaea
