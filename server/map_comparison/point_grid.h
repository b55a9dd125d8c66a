#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

namespace pangaea {

// A cube of space, by its place in a raster of equal cubes.
using SpaceCell = std::uint64_t;
// The cell of a point, edges of length `edge`. Coordinates beyond a million cells share cells.
SpaceCell CellOf(const Eigen::Vector3d& point, double edge);

// Points by where they are: which lie near another. Refers to the points, which stay where they are.
class PointGrid {
 public:
  PointGrid(std::span<const Eigen::Vector3d> points, double radius);
  // The indices of the points within the radius of `point`, in no order that matters.
  void ForEachNear(const Eigen::Vector3d& point, const std::function<void(std::uint32_t)>& visit) const;

 private:
  std::span<const Eigen::Vector3d> points_;
  double radius_;
  std::unordered_map<SpaceCell, std::vector<std::uint32_t>> cells_;
};

}  // namespace pangaea
