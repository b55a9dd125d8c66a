#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/rigid3.h"
#include "common/simulation/ray_kernel.h"
#include "common/simulation/ray_table.h"
#include "common/simulation/scene.h"

namespace pangaea {

// Which surfaces of a scene may be seen in which tile of a camera's picture.
class TileCandidates {
 public:
  explicit TileCandidates(const RayTable& rays);

  // Surfaces that show their back or lie behind others in a whole tile are left out.
  void Fill(const std::vector<Surface>& surfaces, const Rigid3d& camera_from_world);

  // Indices into the surfaces.
  const std::vector<std::int32_t>& OfTile(int tile) const { return tiles_[static_cast<std::size_t>(tile)].visible; }
  const PreparedSurface& prepared(std::int32_t surface) const { return prepared_[static_cast<std::size_t>(surface)]; }

 private:
  struct Tile {
    std::vector<std::int32_t> visible;
    std::vector<float> max_inverse_depth;  // of each of `visible`, over the tile
    // Everything farther than this is hidden by a surface that covers the whole tile.
    float covering_inverse_depth = 0.0F;
  };

  void AddToTiles(const RayTable::Bounds& bounds, std::int32_t surface);
  void AddToTile(std::size_t tile, std::int32_t surface);

  const RayTable& rays_;
  std::vector<PreparedSurface> prepared_;
  std::vector<Tile> tiles_;
};

}  // namespace pangaea
