#include "agent/tracking/patch_alignment.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "agent/tracking/image_sampling.h"

namespace pangaea {
namespace {

constexpr int kWindow = 8;  // pixels
constexpr int kArea = kWindow * kWindow;
constexpr int kBordered = kWindow + 2;  // one more on each side, for central differences
constexpr float kHalfWindow = 0.5F * (kWindow - 1);

// The template as it should look in the current image, on one level of its pyramid, ready for Gauss-Newton.
struct WarpedPatch {
  std::array<float, kArea> values;      // zero mean
  std::array<float, kArea> gradient_u;  // zero mean
  std::array<float, kArea> gradient_v;  // zero mean
  float deviation = 0.0F;               // norm of `values`
  Eigen::Matrix2f inverse_hessian;
};

float RemoveMean(std::array<float, kArea>& values) {
  float sum = 0.0F;
  for (const float value : values) sum += value;
  const float mean = sum / kArea;
  float squares = 0.0F;
  for (float& value : values) {
    value -= mean;
    squares += value * value;
  }
  return std::sqrt(squares);
}

float Dot(const std::array<float, kArea>& a, const std::array<float, kArea>& b) {
  float sum = 0.0F;
  for (int i = 0; i < kArea; ++i) sum += a[i] * b[i];
  return sum;
}

// Samples the crop under `crop_from_level` (2 x 2, crop pixels per level pixel). False when the window does not fit.
bool SampleCrop(const PatchTemplate::Crop& crop, const Eigen::Matrix2f& crop_from_level,
                std::array<float, kBordered * kBordered>& window) {
  const float reach = kHalfWindow + 1.0F;
  const Eigen::Vector2f extent = reach * crop_from_level.cwiseAbs().rowwise().sum();
  const float limit = PatchTemplate::kCropSize - 1.001F;
  if ((crop.center - extent).minCoeff() < 0.0F || (crop.center + extent).maxCoeff() >= limit) return false;
  const Eigen::Vector2f step = crop_from_level.col(0);
  for (int y = 0; y < kBordered; ++y) {
    Eigen::Vector2f at = crop.center + crop_from_level * Eigen::Vector2f(-reach, static_cast<float>(y) - reach);
    for (int x = 0; x < kBordered; ++x, at += step) {
      window[y * kBordered + x] = SampleBilinear(crop.pixels.data(), PatchTemplate::kCropSize, at.x(), at.y());
    }
  }
  return true;
}

std::optional<WarpedPatch> WarpPatch(const PatchTemplate::Crop& crop, const Eigen::Matrix2f& crop_from_level,
                                     double min_texture) {
  std::array<float, kBordered * kBordered> window;
  if (!SampleCrop(crop, crop_from_level, window)) return std::nullopt;
  WarpedPatch patch;
  for (int y = 0; y < kWindow; ++y) {
    for (int x = 0; x < kWindow; ++x) {
      const float* center = &window[(y + 1) * kBordered + x + 1];
      patch.values[y * kWindow + x] = *center;
      patch.gradient_u[y * kWindow + x] = 0.5F * (center[1] - center[-1]);
      patch.gradient_v[y * kWindow + x] = 0.5F * (center[kBordered] - center[-kBordered]);
    }
  }
  patch.deviation = RemoveMean(patch.values);
  RemoveMean(patch.gradient_u);
  RemoveMean(patch.gradient_v);
  const float uu = Dot(patch.gradient_u, patch.gradient_u);
  const float uv = Dot(patch.gradient_u, patch.gradient_v);
  const float vv = Dot(patch.gradient_v, patch.gradient_v);
  const float root = std::sqrt(0.25F * (uu - vv) * (uu - vv) + uv * uv);
  if (0.5F * (uu + vv) - root < static_cast<float>(min_texture) * kArea) return std::nullopt;
  Eigen::Matrix2f hessian;
  hessian << uu, uv, uv, vv;
  patch.inverse_hessian = hessian.inverse();
  return patch;
}

struct LevelMatch {
  Eigen::Vector2f position;  // pixels of the level
  float correlation = 0.0F;
};

// Gauss-Newton on the shift, from `position` in the level's pixels. The gain comes from the ratio of the deviations.
std::optional<LevelMatch> FindShift(const cv::Mat& image, const WarpedPatch& patch, Eigen::Vector2f position,
                                    const PatchAlignmentOptions& options) {
  const Eigen::Vector2f start = position;
  const auto converged = static_cast<float>(options.converged_step * options.converged_step);
  const auto max_shift = static_cast<float>(options.max_shift * options.max_shift);
  std::array<float, kArea> values;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    if (!SamplingFits(image, position.x(), position.y(), kHalfWindow + 1.0)) return std::nullopt;
    SampleWindow<kWindow>(image.ptr<std::uint8_t>(), image.step[0], position.x() - kHalfWindow,
                          position.y() - kHalfWindow, values.data());
    const float deviation = RemoveMean(values);
    if (deviation < 1.0F) return std::nullopt;
    const float gain = patch.deviation / deviation;
    Eigen::Vector2f gradient(gain * Dot(patch.gradient_u, values) - Dot(patch.gradient_u, patch.values),
                             gain * Dot(patch.gradient_v, values) - Dot(patch.gradient_v, patch.values));
    const Eigen::Vector2f step = patch.inverse_hessian * gradient;
    position -= step;
    if (!((position - start).squaredNorm() <= max_shift)) return std::nullopt;
    if (step.squaredNorm() < converged) {
      return LevelMatch{position, Dot(patch.values, values) / (patch.deviation * deviation)};
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Eigen::Matrix2d> CurrentFromTemplate(const IdealCamera& camera, const Rigid3d& current_from_template,
                                                   const Eigen::Vector3d& point_in_template) {
  const Eigen::Vector3d point = current_from_template * point_in_template;
  if (point.z() <= 0.0 || point_in_template.z() <= 0.0) return std::nullopt;
  const double inverse_z = 1.0 / point.z();
  Eigen::Matrix<double, 2, 3> projection;
  projection << camera.focal_x * inverse_z, 0.0, -camera.focal_x * point.x() * inverse_z * inverse_z,  //
      0.0, camera.focal_y * inverse_z, -camera.focal_y * point.y() * inverse_z * inverse_z;
  const Eigen::Matrix3d rotation = current_from_template.rotation().toRotationMatrix();
  // A pixel's step in the template is a step of z / focal length on the plane parallel to its image.
  Eigen::Matrix2d affine = projection * rotation.leftCols<2>();
  affine.col(0) *= point_in_template.z() / camera.focal_x;
  affine.col(1) *= point_in_template.z() / camera.focal_y;
  return affine;
}

bool CanBeAligned(const Eigen::Matrix2d& current_from_template) {
  const double area_ratio = current_from_template.determinant();
  return area_ratio > 0.1 && area_ratio < 10.0;
}

std::optional<AlignedPatch> AlignPatch(const ImagePyramid& image, const PatchTemplate& patch,
                                       const Eigen::Matrix2d& current_from_template, const Eigen::Vector2d& predicted,
                                       bool coarse, const PatchAlignmentOptions& options) {
  if (!CanBeAligned(current_from_template)) return std::nullopt;
  const double area_ratio = current_from_template.determinant();
  const int top = static_cast<int>(image.levels.size()) - 1;
  const int fine_level = std::clamp(patch.level + static_cast<int>(std::lround(0.5 * std::log2(area_ratio))), 0, top);
  const Eigen::Matrix2d template_from_current = current_from_template.inverse();
  const int coarse_steps = coarse && patch.levels > 1 && fine_level < top ? 1 : 0;
  Eigen::Vector2d pixel = predicted;
  double correlation = 0.0;
  for (int step = coarse_steps; step >= 0; --step) {
    const int level = fine_level + step;
    const double level_ratio = std::ldexp(1.0, level - (patch.level + step));
    const auto warped =
        WarpPatch(patch.crops[step], (template_from_current * level_ratio).cast<float>(), options.min_texture);
    if (!warped) {
      if (step > 0) continue;  // without texture on the coarse level the fine one may still have some
      return std::nullopt;
    }
    const auto match = FindShift(image.levels[level], *warped, LevelFromFull(pixel, level).cast<float>(), options);
    if (!match) return std::nullopt;
    pixel = FullFromLevel(match->position.cast<double>(), level);
    correlation = match->correlation;
  }
  if (correlation < options.min_correlation) return std::nullopt;
  return AlignedPatch{pixel, fine_level, correlation};
}

}  // namespace pangaea
