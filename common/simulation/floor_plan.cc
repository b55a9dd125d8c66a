#include "common/simulation/floor_plan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace pangaea {
namespace {

using Eigen::Vector3d;

const Vector3d kUp = Vector3d::UnitZ();
// Texels, metres: fine where cameras come near.
constexpr double kLargeTexel = 0.005;
constexpr double kSmallTexel = 0.0035;
constexpr double kHighTexel = 0.008;  // of what is near the ceiling
constexpr double kHigh = 4.0;         // metres

double TexelOf(double height_above_floor, double width, double height) {
  if (height_above_floor > kHigh) return kHighTexel;
  return std::min(width, height) < 0.5 ? kSmallTexel : kLargeTexel;
}

}  // namespace

void FloorPlan::AddRectangle(const Vector3d& center, const Vector3d& normal, const Vector3d& up, double width,
                             double height, Material material, double texel) {
  const Vector3d right = up.cross(normal);
  const Vector3d corner = center - 0.5 * width * right + 0.5 * height * up;
  surfaces.push_back({{corner, width * right, -height * up, nullptr}, material, texel});
}

void FloorPlan::AddBox(const Vector3d& center, const Vector3d& half, double yaw, Material material, bool shows_bottom) {
  scene.solids.push_back({center, half, {std::cos(yaw), std::sin(yaw)}});
  const Vector3d x(std::cos(yaw), std::sin(yaw), 0.0);
  const Vector3d y(-x.y(), x.x(), 0.0);
  const auto face = [&](const Vector3d& normal, const Vector3d& up, double off, double width, double height) {
    AddRectangle(center + off * normal, normal, up, width, height, material, TexelOf(center.z(), width, height));
  };
  for (const double side : {-1.0, 1.0}) {
    face(side * x, kUp, half.x(), 2.0 * half.y(), 2.0 * half.z());
    face(side * y, kUp, half.y(), 2.0 * half.x(), 2.0 * half.z());
  }
  face(kUp, y, half.z(), 2.0 * half.x(), 2.0 * half.y());
  if (shows_bottom) face(-kUp, y, half.z(), 2.0 * half.x(), 2.0 * half.y());
}

FloorPlan PlanOccluder(std::uint64_t seed) {
  FloorPlan plan;
  Random random(seed);
  plan.AddBox({0.0, 0.0, 0.75}, {0.24, 0.18, 0.75}, random.Uniform(0.0, 3.0), Material::kFabric);
  plan.AddBox({0.0, 0.0, 1.64}, {0.11, 0.11, 0.14}, random.Uniform(0.0, 3.0), Material::kCarton, true);
  return plan;
}

}  // namespace pangaea
