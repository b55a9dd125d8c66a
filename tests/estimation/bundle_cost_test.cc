#include "common/estimation/bundle_cost.h"

#include <gtest/gtest.h>

#include "tests/estimation/synthetic_world.h"

namespace pangaea::testing {
namespace {

TEST(BundleCost, AnalyticJacobiansAreTheNumericOnes) {
  const PoseManifold manifold;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const bool stereo = seed % 2 == 0;
    const IdealCamera camera = StereoCamera();
    const Rigid3d pose = Perturbed(random, Rigid3d(), 2.0, 2.0);
    const Eigen::Vector3d point_in_camera = VisiblePoint(random, camera, 1.0, 10.0);
    const Eigen::Vector3d point = pose.Inverse() * point_in_camera;
    BundleObservation observation;
    observation.measurement = Measure(camera, point_in_camera) + UniformVector(random, 3.0);
    if (stereo) observation.measurement.z() = std::abs(observation.measurement.z());
    if (!stereo) observation.measurement.z() = -1.0;
    observation.inverse_sigma = 0.7;
    const auto cost = MakeBundleCost(camera, observation);
    const int residuals = cost->num_residuals();
    ASSERT_EQ(residuals, stereo ? 3 : 2);

    const PoseParameters x = ToParameters(pose);
    const auto evaluate = [&](const PoseParameters& at, const Eigen::Vector3d& where) {
      const double* parameters[] = {at.data(), where.data()};
      Eigen::VectorXd residual(residuals);
      cost->Evaluate(parameters, residual.data(), nullptr);
      return residual;
    };
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    RowMajor by_pose(residuals, 7), by_point(residuals, 3), plus(7, 6);
    double* jacobians[] = {by_pose.data(), by_point.data()};
    const double* parameters[] = {x.data(), point.data()};
    Eigen::VectorXd residual(residuals);
    cost->Evaluate(parameters, residual.data(), jacobians);
    manifold.PlusJacobian(x.data(), plus.data());
    const RowMajor by_twist = by_pose * plus;

    const double h = 1e-6;
    for (int k = 0; k < 6; ++k) {
      PoseParameters above, below;
      const Vector6d step = h * Vector6d::Unit(k);
      const Vector6d back = -step;
      manifold.Plus(x.data(), step.data(), above.data());
      manifold.Plus(x.data(), back.data(), below.data());
      const Eigen::VectorXd numeric = (evaluate(above, point) - evaluate(below, point)) / (2.0 * h);
      EXPECT_LT((by_twist.col(k) - numeric).norm(), 1e-5 * (1.0 + numeric.norm())) << "seed " << seed << " k " << k;
    }
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(k);
      const Eigen::VectorXd numeric = (evaluate(x, point + step) - evaluate(x, point - step)) / (2.0 * h);
      EXPECT_LT((by_point.col(k) - numeric).norm(), 1e-5 * (1.0 + numeric.norm())) << "seed " << seed << " k " << k;
    }
  }
}

TEST(PoseManifold, MinusUndoesPlus) {
  const PoseManifold manifold;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const PoseParameters x = ToParameters(Perturbed(random, Rigid3d(), 2.0, 1.5));
    Vector6d step;
    step << UniformVector(random, 1.0), UniformVector(random, 1.0);
    PoseParameters y;
    Vector6d difference;
    manifold.Plus(x.data(), step.data(), y.data());
    manifold.Minus(y.data(), x.data(), difference.data());
    EXPECT_LT((difference - step).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace pangaea::testing
