#include "common/simulation/ray_table.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"

namespace pangaea {
namespace {

// The bounds of a tile's pixel centres, grown so that they hold the whole pixels.
RayTable::Bounds BoundsOfTile(const float* x, const float* y) {
  constexpr int n = RayTable::kTilePixels;
  const auto [min_x, max_x] = std::minmax_element(x, x + n);
  const auto [min_y, max_y] = std::minmax_element(y, y + n);
  // A pixel reaches half a pixel beyond its centre; the lens may stretch it a little more at the rim.
  const float margin_x = 0.75F * (*max_x - *min_x) / (RayTable::kTileWidth - 1);
  const float margin_y = 0.75F * (*max_y - *min_y) / (RayTable::kTileHeight - 1);
  return {*min_x - margin_x, *max_x + margin_x, *min_y - margin_y, *max_y + margin_y};
}

}  // namespace

RayTable::RayTable(const LensModel& lens)
    : width(lens.width), height(lens.height), tiles_across(width / kTileWidth), tiles_down(height / kTileHeight) {
  PANGAEA_CHECK(width % kTileWidth == 0 && height % kTileHeight == 0);
  x.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  y.reserve(x.capacity());
  for (int tile = 0; tile < tiles_across * tiles_down; ++tile) {
    const int left = tile % tiles_across * kTileWidth;
    const int top = tile / tiles_across * kTileHeight;
    for (int i = 0; i < kTilePixels; ++i) {
      const auto ray = lens.Unproject({left + i % kTileWidth, top + i / kTileWidth});
      PANGAEA_CHECK(ray.has_value());
      x.push_back(static_cast<float>(ray->x()));
      y.push_back(static_cast<float>(ray->y()));
    }
    const std::size_t first = x.size() - kTilePixels;
    tile_bounds.push_back(BoundsOfTile(&x[first], &y[first]));
    if (left == 0) row_bounds.push_back(tile_bounds.back());
    Bounds& row = row_bounds.back();
    const Bounds& added = tile_bounds.back();
    row = {std::min(row.min_x, added.min_x), std::max(row.max_x, added.max_x), std::min(row.min_y, added.min_y),
           std::max(row.max_y, added.max_y)};
  }
}

}  // namespace pangaea
