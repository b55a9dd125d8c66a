#include "common/simulation/tile_candidates.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <optional>

namespace pangaea {
namespace {

// Nearer than this to the camera's plane (metres), corners are not projected: the surface may cover any tile.
constexpr double kNear = 0.02;

struct Range {
  float low, high;
};

// Of a linear function over a tile.
Range RangeOver(const float f[3], const RayTable::Bounds& b) {
  const float x0 = f[0] * b.min_x, x1 = f[0] * b.max_x;
  const float y0 = f[1] * b.min_y, y1 = f[1] * b.max_y;
  return {std::min(x0, x1) + std::min(y0, y1) + f[2], std::max(x0, x1) + std::max(y0, y1) + f[2]};
}

void Store(const Eigen::Vector3d& from, float to[3]) {
  for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(from[i]);
}

struct ProjectedSurface {
  PreparedSurface prepared;
  RayTable::Bounds bounds;
};

// Nothing where the surface shows its back or lies behind the camera.
std::optional<ProjectedSurface> Project(const Surface& surface, const Eigen::Matrix3d& rotation,
                                        const Eigen::Vector3d& translation) {
  const Eigen::Vector3d corner = rotation * surface.corner + translation;
  const Eigen::Vector3d along = rotation * surface.along;
  const Eigen::Vector3d across = rotation * surface.across;
  const Eigen::Vector3d normal = along.cross(across);
  const double determinant = normal.dot(corner);
  if (determinant <= 1e-9) return std::nullopt;
  constexpr float kFar = std::numeric_limits<float>::max();
  ProjectedSurface projected{{}, {kFar, -kFar, kFar, -kFar}};
  RayTable::Bounds& b = projected.bounds;
  int in_front = 0;
  for (const double s : {0.0, 1.0}) {
    for (const double t : {0.0, 1.0}) {
      const Eigen::Vector3d vertex = corner + s * along + t * across;
      if (vertex.z() < kNear) continue;
      ++in_front;
      const auto x = static_cast<float>(vertex.x() / vertex.z());
      const auto y = static_cast<float>(vertex.y() / vertex.z());
      b = {std::min(b.min_x, x), std::max(b.max_x, x), std::min(b.min_y, y), std::max(b.max_y, y)};
    }
  }
  if (in_front == 0) return std::nullopt;
  if (in_front < 4) b = {-kFar, kFar, -kFar, kFar};
  Store(across.cross(corner) / determinant, projected.prepared.s);
  Store(corner.cross(along) / determinant, projected.prepared.t);
  Store(normal / determinant, projected.prepared.w);
  return projected;
}

bool Overlap(const RayTable::Bounds& a, const RayTable::Bounds& b) {
  return a.max_x >= b.min_x && a.min_x <= b.max_x && a.max_y >= b.min_y && a.min_y <= b.max_y;
}

}  // namespace

TileCandidates::TileCandidates(const RayTable& rays) : rays_(rays), tiles_(rays.tile_bounds.size()) {}

void TileCandidates::Fill(const std::vector<Surface>& surfaces, const Rigid3d& camera_from_world) {
  for (Tile& tile : tiles_) {
    tile.visible.clear();
    tile.max_inverse_depth.clear();
    tile.covering_inverse_depth = 0.0F;
  }
  prepared_.resize(surfaces.size());
  const Eigen::Matrix3d rotation = camera_from_world.rotation().toRotationMatrix();
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const auto projected = Project(surfaces[i], rotation, camera_from_world.translation());
    if (!projected) continue;
    prepared_[i] = projected->prepared;
    AddToTiles(projected->bounds, static_cast<std::int32_t>(i));
  }
  for (Tile& tile : tiles_) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < tile.visible.size(); ++i) {
      if (tile.max_inverse_depth[i] >= tile.covering_inverse_depth) tile.visible[kept++] = tile.visible[i];
    }
    tile.visible.resize(kept);
  }
}

void TileCandidates::AddToTiles(const RayTable::Bounds& bounds, std::int32_t surface) {
  for (int row = 0; row < rays_.tiles_down; ++row) {
    if (!Overlap(rays_.row_bounds[static_cast<std::size_t>(row)], bounds)) continue;
    for (int column = 0; column < rays_.tiles_across; ++column) {
      const auto tile = static_cast<std::size_t>(row * rays_.tiles_across + column);
      const RayTable::Bounds& of_tile = rays_.tile_bounds[tile];
      if (of_tile.min_x > bounds.max_x) break;
      if (Overlap(of_tile, bounds)) AddToTile(tile, surface);
    }
  }
}

void TileCandidates::AddToTile(std::size_t tile, std::int32_t surface) {
  const RayTable::Bounds& bounds = rays_.tile_bounds[tile];
  const PreparedSurface& p = prepared_[static_cast<std::size_t>(surface)];
  Tile& target = tiles_[tile];
  const Range w = RangeOver(p.w, bounds);
  if (w.high <= target.covering_inverse_depth) return;
  const float s_rest[3] = {p.w[0] - p.s[0], p.w[1] - p.s[1], p.w[2] - p.s[2]};
  const float t_rest[3] = {p.w[0] - p.t[0], p.w[1] - p.t[1], p.w[2] - p.t[2]};
  bool covers = w.low > 0.0F;
  for (const float* side : {p.s, p.t, s_rest, t_rest}) {
    const Range range = RangeOver(side, bounds);
    if (range.high < 0.0F) return;
    covers = covers && range.low > 0.0F;
  }
  // A hair less than the farthest point, so that rounding never lets the covering surface hide itself.
  if (covers) target.covering_inverse_depth = std::max(target.covering_inverse_depth, 0.9999F * w.low);
  target.visible.push_back(surface);
  target.max_inverse_depth.push_back(w.high);
}

}  // namespace pangaea
