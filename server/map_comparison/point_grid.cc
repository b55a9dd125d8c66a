#include "server/map_comparison/point_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pangaea {
namespace {

constexpr double kFarthest = 1 << 20;  // cells from the origin: 21 bits hold both signs

std::uint64_t Coordinate(double value) {
  if (std::isnan(value)) return 0;
  return static_cast<std::uint64_t>(std::clamp(std::floor(value), -kFarthest, kFarthest - 1.0) + kFarthest);
}

}  // namespace

SpaceCell CellOf(const Eigen::Vector3d& point, double edge) {
  return Coordinate(point.x() / edge) << 42U | Coordinate(point.y() / edge) << 21U | Coordinate(point.z() / edge);
}

PointGrid::PointGrid(std::span<const Eigen::Vector3d> points, double radius) : points_(points), radius_(radius) {
  for (std::uint32_t i = 0; i < points.size(); ++i) cells_[CellOf(points[i], radius)].push_back(i);
}

void PointGrid::ForEachNear(const Eigen::Vector3d& point, const std::function<void(std::uint32_t)>& visit) const {
  std::array<SpaceCell, 27> around;
  std::size_t next = 0;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) around[next++] = CellOf(point + radius_ * Eigen::Vector3d(x, y, z), radius_);
    }
  }
  // Beyond a million cells several are one.
  std::ranges::sort(around);
  const auto end = std::unique(around.begin(), around.end());
  for (auto id = around.begin(); id != end; ++id) {
    const auto cell = cells_.find(*id);
    if (cell == cells_.end()) continue;
    for (const std::uint32_t index : cell->second) {
      if ((points_[index] - point).squaredNorm() <= radius_ * radius_) visit(index);
    }
  }
}

}  // namespace pangaea
