#pragma once

#include <vector>

#include "common/sensor/lens.h"

namespace pangaea {

// The rays of a camera's pixels at z = 1, in tiles, through the lens as it is: distortion costs nothing later.
// The picture's sizes must be multiples of the tile's.
struct RayTable {
  static constexpr int kTileWidth = 16;
  static constexpr int kTileHeight = 8;
  static constexpr int kTilePixels = kTileWidth * kTileHeight;
  struct Bounds {
    float min_x, max_x, min_y, max_y;
  };

  explicit RayTable(const LensModel& lens);

  int width;   // pixels
  int height;  // pixels
  int tiles_across;
  int tiles_down;
  std::vector<float> x, y;          // of the pixels' centres, tile by tile, row by row
  std::vector<Bounds> tile_bounds;  // of everything the tile's pixels cover
  std::vector<Bounds> row_bounds;   // of a row of tiles
};

}  // namespace pangaea
