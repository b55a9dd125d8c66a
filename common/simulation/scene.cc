#include "common/simulation/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pangaea {

double Solid::Distance(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d beyond = ToLocal(point - center).cwiseAbs() - half_size;
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

double Scene::Clearance(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d center(0.0, 0.0, half_size.z());
  double clearance = (half_size - (point - center).cwiseAbs()).minCoeff();
  for (const Solid& solid : solids) clearance = std::min(clearance, solid.Distance(point));
  return clearance;
}

void Occluder::AppendSurfaces(double seconds, const Eigen::Vector3d& body_in_world,
                              std::vector<Surface>& surfaces_out) const {
  constexpr double kReach = 1.2;  // metres
  const double angle = 2.0 * std::numbers::pi * (phase + seconds / period);
  Eigen::Vector3d foot(radius_x * std::cos(angle), radius_y * std::sin(angle), 0.0);
  const Eigen::Vector2d away = foot.head<2>() - body_in_world.head<2>();
  const double distance = std::max(away.norm(), 1e-6);
  if (distance < kReach) foot.head<2>() += (kReach - distance) / distance * away;
  for (Surface surface : surfaces) {
    surface.corner += foot;
    surfaces_out.push_back(std::move(surface));
  }
}

}  // namespace pangaea
