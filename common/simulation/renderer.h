#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/rigid3.h"
#include "common/sensor/lens.h"
#include "common/simulation/scene.h"

namespace pangaea {

// The rays of a camera's pixels at z = 1, in tiles, through the lens as it is: distortion costs nothing later.
// Sizes must be multiples of the tile's.
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

// Draws a scene as one camera sees it: per pixel the nearest surface along the pixel's own ray, its texture filtered
// over the pixel's footprint, and eight rays where a pixel shows more than one surface. Keeps scratch memory from
// picture to picture: one renderer per thread.
class Renderer {
 public:
  explicit Renderer(std::shared_ptr<const RayTable> rays);
  ~Renderer();
  Renderer(Renderer&&) noexcept;

  // Grey values 0 to 255 as 32-bit floats, no noise. Black where no surface is hit.
  void Render(const std::vector<Surface>& surfaces, const Rigid3d& camera_from_world, cv::Mat& image);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace pangaea
