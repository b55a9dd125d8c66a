#pragma once

#include <ceres/cost_function.h>
#include <ceres/manifold.h>

#include <array>
#include <memory>

#include "common/estimation/bundle_adjustment.h"

namespace pangaea {

// A pose as Ceres sees it: quaternion x, y, z, w, then the translation.
using PoseParameters = std::array<double, 7>;
PoseParameters ToParameters(const Rigid3d& pose);
Rigid3d ToRigid(const PoseParameters& parameters);

// x plus e is Exp(e) * x, e = (translation, rotation). Cost functions on this manifold write their derivative by e
// into the first six of the seven columns, and PlusJacobian is (I; 0): the product is the derivative by e, and nobody
// has to lift it to quaternions and back. So PlusJacobian is no derivative of Plus, by intent.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

// The weighted reprojection error (2 residuals, stereo 3) as a function of a pose on PoseManifold and a point.
std::unique_ptr<ceres::CostFunction> MakeBundleCost(const IdealCamera& camera, const BundleObservation& observation);

}  // namespace pangaea
