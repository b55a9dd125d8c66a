#include "common/simulation/lighting.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace pangaea {
namespace {

constexpr double kLargeHalfSize = 0.28;  // metres
constexpr float kAmbient = 0.62F;        // light from everywhere
constexpr double kLampStrength = 7.5;    // of all lamps, against the square of metres
constexpr float kLampLimit = 1.0F;
constexpr double kLift = 0.02;  // metres off the surface, so that a solid does not shade its own face

// Where the segment from a to b enters the box, by slabs (Kay and Kajiya 1986).
bool Blocks(const Solid& solid, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d from = solid.ToLocal(a - solid.center);
  const Eigen::Vector3d along = solid.ToLocal(b - a);
  double enter = 0.0;
  double leave = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double inverse = 1.0 / (std::abs(along[axis]) > 1e-12 ? along[axis] : 1e-12);
    const double t0 = (-solid.half_size[axis] - from[axis]) * inverse;
    const double t1 = (solid.half_size[axis] - from[axis]) * inverse;
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return enter < leave;
}

}  // namespace

Lighting::Lighting(const Scene& scene, std::vector<Eigen::Vector3d> lamps) : lamps_(std::move(lamps)) {
  large_solids_.half_size = scene.half_size;
  for (const Solid& solid : scene.solids) {
    if (solid.half_size.maxCoeff() >= kLargeHalfSize) large_solids_.solids.push_back(solid);
  }
}

LightGrid Lighting::Light(const Surface& surface, double spacing) const {
  const auto samples = [spacing](double size) { return std::max(static_cast<int>(size / spacing) + 1, 2); };
  const Eigen::Vector3d normal = surface.across.cross(surface.along).normalized();
  if (surface.along.norm() < spacing && surface.across.norm() < spacing) {
    const Eigen::Vector3d middle = surface.corner + 0.5 * (surface.along + surface.across);
    return {1, 1, {At(middle + kLift * normal, normal)}};
  }
  LightGrid grid{samples(surface.along.norm()), samples(surface.across.norm()), {}};
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      // Off the very edge, where the next wall would swallow the sample.
      const double s = std::clamp(static_cast<double>(column) / (grid.columns - 1), 0.03, 0.97);
      const double t = std::clamp(static_cast<double>(row) / (grid.rows - 1), 0.03, 0.97);
      grid.values.push_back(At(surface.corner + s * surface.along + t * surface.across + kLift * normal, normal));
    }
  }
  return grid;
}

float Lighting::At(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  double direct = 0.0;
  for (const Eigen::Vector3d& lamp : lamps_) {
    const Eigen::Vector3d to_lamp = lamp - point;
    const double cosine = normal.dot(to_lamp);
    if (cosine <= 0.0 || !Sees(point, lamp)) continue;
    direct += kLampStrength * cosine / (to_lamp.norm() * (to_lamp.squaredNorm() + 3.0));
  }
  // Surfaces turned different ways differ in brightness even in the shade, so that edges show.
  const auto tilt = static_cast<float>(0.06 * normal.x() + 0.09 * normal.y() + 0.05 * normal.z());
  return (kAmbient + tilt) * static_cast<float>(Openness(point, normal)) +
         std::min(static_cast<float>(direct), kLampLimit);
}

double Lighting::Openness(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  constexpr std::array<double, 3> kDistances = {0.12, 0.35, 0.9};
  double closed = 0.0;
  for (const double distance : kDistances) {
    const double clearance = large_solids_.Clearance(point + distance * normal);
    closed += 0.22 * std::clamp(1.0 - clearance / distance, 0.0, 1.0);
  }
  return 1.0 - closed;
}

bool Lighting::Sees(const Eigen::Vector3d& point, const Eigen::Vector3d& lamp) const {
  return std::none_of(large_solids_.solids.begin(), large_solids_.solids.end(),
                      [&](const Solid& solid) { return Blocks(solid, point, lamp); });
}

}  // namespace pangaea
