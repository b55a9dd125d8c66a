#include "agent/tracking/sparse_alignment.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "agent/tracking/image_sampling.h"

namespace pangaea {
namespace {

constexpr int kWindow = 4;  // pixels of the level
constexpr int kArea = kWindow * kWindow;
constexpr int kBordered = kWindow + 2;
constexpr float kHalfWindow = 0.5F * (kWindow - 1);

using Vector6f = Eigen::Matrix<float, 6, 1>;
using Matrix6f = Eigen::Matrix<float, 6, 6>;

// One point's patch in the previous image. The Jacobian of pixel i is gradient(i)' * projection.
struct ReferencePatch {
  Eigen::Vector3d point;  // camera frame of the previous image
  std::array<float, kArea> values;
  std::array<float, kArea> gradient_u;
  std::array<float, kArea> gradient_v;
  Eigen::Matrix<float, 2, 6> projection;  // d(pixel of the level) / d(twist of the previous camera)
};

// d pixel / d twist at `point` for point <- Exp(twist) * point, in pixels of the level.
Eigen::Matrix<float, 2, 6> ProjectionJacobian(const IdealCamera& camera, const Eigen::Vector3d& point, double scale) {
  const double inverse_z = 1.0 / point.z();
  const double a = point.x() * inverse_z;
  const double b = point.y() * inverse_z;
  Eigen::Matrix<double, 2, 6> jacobian;
  jacobian << inverse_z, 0.0, -a * inverse_z, -a * b, 1.0 + a * a, -b,  //
      0.0, inverse_z, -b * inverse_z, -1.0 - b * b, a * b, a;
  jacobian.row(0) *= camera.focal_x * scale;
  jacobian.row(1) *= camera.focal_y * scale;
  return jacobian.cast<float>();
}

std::vector<ReferencePatch> CutReferencePatches(const cv::Mat& image, int level, const IdealCamera& camera,
                                                std::span<const Eigen::Vector3d> points) {
  std::vector<ReferencePatch> patches;
  patches.reserve(points.size());
  std::array<float, kBordered * kBordered> window;
  for (const Eigen::Vector3d& point : points) {
    if (point.z() <= 0.0) continue;
    const Eigen::Vector2d pixel = LevelFromFull(camera.Project(point), level);
    if (!SamplingFits(image, pixel.x(), pixel.y(), kHalfWindow + 2.0)) continue;
    SampleWindow<kBordered>(image.ptr<std::uint8_t>(), image.step[0],
                            static_cast<float>(pixel.x()) - kHalfWindow - 1.0F,
                            static_cast<float>(pixel.y()) - kHalfWindow - 1.0F, window.data());
    ReferencePatch& patch = patches.emplace_back();
    patch.point = point;
    patch.projection = ProjectionJacobian(camera, point, std::ldexp(1.0, -level));
    for (int y = 0; y < kWindow; ++y) {
      for (int x = 0; x < kWindow; ++x) {
        const float* center = &window[(y + 1) * kBordered + x + 1];
        patch.values[y * kWindow + x] = *center;
        patch.gradient_u[y * kWindow + x] = 0.5F * (center[1] - center[-1]);
        patch.gradient_v[y * kWindow + x] = 0.5F * (center[kBordered] - center[-kBordered]);
      }
    }
  }
  return patches;
}

struct NormalEquations {
  Matrix6f hessian = Matrix6f::Zero();
  Vector6f gradient = Vector6f::Zero();
  double cost = 0.0;  // robust, per pixel
  int points = 0;
};

// `brightness` is the mean difference of the two images, found in the previous iteration and updated here.
NormalEquations Linearise(const cv::Mat& image, int level, const IdealCamera& camera,
                          std::span<const ReferencePatch> patches, const Rigid3d& current_from_previous,
                          const SparseAlignmentOptions& options, float& brightness) {
  NormalEquations equations;
  const auto huber = static_cast<float>(options.huber);
  std::array<float, kArea> values;
  double sum_of_differences = 0.0;
  for (const ReferencePatch& patch : patches) {
    const Eigen::Vector3d point = current_from_previous * patch.point;
    if (point.z() <= 0.0) continue;
    const Eigen::Vector2d pixel = LevelFromFull(camera.Project(point), level);
    if (!SamplingFits(image, pixel.x(), pixel.y(), kHalfWindow + 1.0)) continue;
    SampleWindow<kWindow>(image.ptr<std::uint8_t>(), image.step[0], static_cast<float>(pixel.x()) - kHalfWindow,
                          static_cast<float>(pixel.y()) - kHalfWindow, values.data());
    // The 2x2 structure of the patch first, its lift to six parameters once per patch.
    Eigen::Matrix2f structure = Eigen::Matrix2f::Zero();
    Eigen::Vector2f shift = Eigen::Vector2f::Zero();
    for (int i = 0; i < kArea; ++i) {
      const float difference = values[i] - patch.values[i];
      sum_of_differences += difference;
      const float residual = difference - brightness;
      const float magnitude = std::abs(residual);
      const float weight = magnitude <= huber ? 1.0F : huber / magnitude;
      equations.cost += magnitude <= huber ? 0.5F * residual * residual : huber * (magnitude - 0.5F * huber);
      const Eigen::Vector2f gradient(patch.gradient_u[i], patch.gradient_v[i]);
      structure += weight * gradient * gradient.transpose();
      shift += weight * residual * gradient;
    }
    equations.hessian += patch.projection.transpose() * structure * patch.projection;
    equations.gradient += patch.projection.transpose() * shift;
    ++equations.points;
  }
  if (equations.points > 0) {
    equations.cost /= static_cast<double>(equations.points) * kArea;
    brightness = static_cast<float>(sum_of_differences / (static_cast<double>(equations.points) * kArea));
  }
  return equations;
}

// Gauss-Newton on one level; keeps the motion of the lowest cost. False when too few points are visible.
bool AlignLevel(const cv::Mat& image, int level, const IdealCamera& camera, std::span<const ReferencePatch> patches,
                const SparseAlignmentOptions& options, Rigid3d& current_from_previous) {
  Rigid3d trial = current_from_previous;
  double best_cost = std::numeric_limits<double>::infinity();
  float brightness = 0.0F;
  Linearise(image, level, camera, patches, trial, options, brightness);
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const NormalEquations equations = Linearise(image, level, camera, patches, trial, options, brightness);
    if (equations.points < options.min_points) return false;
    if (!(equations.cost < best_cost)) break;
    best_cost = equations.cost;
    current_from_previous = trial;
    const Vector6f step = equations.hessian.ldlt().solve(equations.gradient);
    if (!step.allFinite()) break;
    // The step moves the template; its inverse moves the image (inverse composition).
    trial = trial * Rigid3d::Exp(-step.cast<double>());
    if (step.norm() < static_cast<float>(options.converged_step)) break;
  }
  return true;
}

}  // namespace

std::optional<Rigid3d> AlignSparsely(const ImagePyramid& previous, const ImagePyramid& current,
                                     const IdealCamera& camera, std::span<const Eigen::Vector3d> points_in_previous,
                                     const Rigid3d& initial, const SparseAlignmentOptions& options) {
  Rigid3d current_from_previous = initial;
  const int top = static_cast<int>(previous.levels.size()) - 1;
  for (int level = std::min(options.coarsest_level, top); level >= options.finest_level; --level) {
    const auto patches = CutReferencePatches(previous.levels[level], level, camera, points_in_previous);
    if (!AlignLevel(current.levels[level], level, camera, patches, options, current_from_previous)) return std::nullopt;
  }
  return current_from_previous;
}

}  // namespace pangaea
