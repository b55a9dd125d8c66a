#include "common/simulation/renderer.h"

#include <algorithm>
#include <array>

#include "common/simulation/tile_candidates.h"

namespace pangaea {
namespace {

constexpr int kTileWidth = RayTable::kTileWidth;
constexpr int kTileHeight = RayTable::kTileHeight;
constexpr int kTilePixels = RayTable::kTilePixels;
constexpr int kMaxProbes = 4;
// Rays of a pixel that shows an edge: eight columns and rows of the pixel have one each.
constexpr int kSubrays = 8;
constexpr std::array<float, kSubrays> kSubrayColumn = {-0.4375F, -0.3125F, -0.1875F, -0.0625F,
                                                       0.0625F,  0.1875F,  0.3125F,  0.4375F};
constexpr std::array<float, kSubrays> kSubrayRow = {0.0625F, -0.3125F, 0.3125F, -0.0625F,
                                                    0.4375F, -0.1875F, 0.1875F, -0.4375F};

// The Jacobian of the ray (x, y) by the pixel's (column, row), taken over a whole tile: the lens changes slowly.
struct RayStep {
  float x_column, x_row, y_column, y_row;
};

RayStep StepOfTile(const float* x, const float* y) {
  constexpr int kMiddleRow = kTileHeight / 2 * kTileWidth;
  constexpr int kMiddleColumn = kTileWidth / 2;
  constexpr int kBottom = kMiddleColumn + (kTileHeight - 1) * kTileWidth;
  return {(x[kMiddleRow + kTileWidth - 1] - x[kMiddleRow]) / (kTileWidth - 1),
          (x[kBottom] - x[kMiddleColumn]) / (kTileHeight - 1),
          (y[kMiddleRow + kTileWidth - 1] - y[kMiddleRow]) / (kTileWidth - 1),
          (y[kBottom] - y[kMiddleColumn]) / (kTileHeight - 1)};
}

Footprint FootprintAt(const PreparedSurface& p, const SurfacePoint& at, const RayStep& step) {
  const float s_x = (p.s[0] - at.s * p.w[0]) * at.depth, s_y = (p.s[1] - at.s * p.w[1]) * at.depth;
  const float t_x = (p.t[0] - at.t * p.w[0]) * at.depth, t_y = (p.t[1] - at.t * p.w[1]) * at.depth;
  return {s_x * step.x_column + s_y * step.y_column, s_x * step.x_row + s_y * step.y_row,
          t_x * step.x_column + t_y * step.y_column, t_x * step.x_row + t_y * step.y_row};
}

// The filter of a surface in one row of a tile, found at its first pixel there: it hardly changes along sixteen.
struct RowFilter {
  std::int32_t surface = -1;
  TextureFilter filter;
};

// A tile's place in the picture.
struct TilePlace {
  int index;
  int left, top;       // pixels
  const float *x, *y;  // its rays
  RayStep step;
};

}  // namespace

class Renderer::Picture {
 public:
  explicit Picture(std::shared_ptr<const RayTable> rays)
      : rays_(std::move(rays)),
        stride_(rays_->width + 2),
        candidates_(*rays_),
        nearest_(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rays_->height + 2)) {}

  void Render(const std::vector<Surface>& surfaces, const Rigid3d& camera_from_world, cv::Mat& image);

 private:
  TilePlace Place(int tile) const;
  // Of a pixel's centre; one beyond each side of the picture repeats the border.
  std::int32_t* Nearest(int column, int row) {
    return &nearest_[static_cast<std::size_t>((row + 1) * stride_ + column + 1)];
  }
  void Trace(int tile, int count, const float* x, const float* y);
  void TraceTile(const TilePlace& tile);
  void RepeatBorder();
  void ShadeTile(const TilePlace& tile, const std::vector<Surface>& surfaces, cv::Mat& image);
  void ShadeSinglePixels(const TilePlace& tile, int first, const std::vector<Surface>& surfaces, RowFilter& known,
                         float* values);
  void FindFilter(const TilePlace& tile, std::int32_t surface, const Texture& texture, int pixel,
                  RowFilter& known) const;
  int FindEdges(const TilePlace& tile);
  void ShadeEdges(const TilePlace& tile, int count, const std::vector<Surface>& surfaces, cv::Mat& image);
  TextureFilter FilterAt(const TilePlace& tile, std::int32_t surface, const Texture& texture, float x, float y,
                         int max_probes) const;

  std::shared_ptr<const RayTable> rays_;
  int stride_;
  TileCandidates candidates_;
  std::vector<std::int32_t> nearest_;
  // Scratch of one tile.
  std::array<float, kTilePixels * kSubrays> inverse_depth_, x_, y_;
  std::array<std::int32_t, kTilePixels * kSubrays> surface_;
  std::array<int, kTilePixels> edge_pixels_;
};

TilePlace Renderer::Picture::Place(int tile) const {
  const float* x = &rays_->x[static_cast<std::size_t>(tile * kTilePixels)];
  const float* y = &rays_->y[static_cast<std::size_t>(tile * kTilePixels)];
  return {
      tile, tile % rays_->tiles_across * kTileWidth, tile / rays_->tiles_across * kTileHeight, x, y, StepOfTile(x, y)};
}

void Renderer::Picture::Trace(int tile, int count, const float* x, const float* y) {
  std::fill_n(inverse_depth_.begin(), count, 0.0F);
  std::fill_n(surface_.begin(), count, -1);
  for (const std::int32_t candidate : candidates_.OfTile(tile)) {
    IntersectSurface(candidates_.prepared(candidate), candidate, count, x, y, {inverse_depth_.data(), surface_.data()});
  }
}

void Renderer::Picture::TraceTile(const TilePlace& tile) {
  Trace(tile.index, kTilePixels, tile.x, tile.y);
  for (int row = 0; row < kTileHeight; ++row) {
    std::copy_n(surface_.begin() + row * kTileWidth, kTileWidth, Nearest(tile.left, tile.top + row));
  }
}

void Renderer::Picture::RepeatBorder() {
  for (int row = 0; row < rays_->height; ++row) {
    *Nearest(-1, row) = *Nearest(0, row);
    *Nearest(rays_->width, row) = *Nearest(rays_->width - 1, row);
  }
  std::copy_n(Nearest(-1, 0), stride_, Nearest(-1, -1));
  std::copy_n(Nearest(-1, rays_->height - 1), stride_, Nearest(-1, rays_->height));
}

TextureFilter Renderer::Picture::FilterAt(const TilePlace& tile, std::int32_t surface, const Texture& texture, float x,
                                          float y, int max_probes) const {
  const PreparedSurface& prepared = candidates_.prepared(surface);
  return ChooseFilter(texture, FootprintAt(prepared, Meet(prepared, x, y), tile.step), max_probes);
}

void Renderer::Picture::ShadeTile(const TilePlace& tile, const std::vector<Surface>& surfaces, cv::Mat& image) {
  RowFilter known;
  for (int first = 0; first < kTilePixels; first += kRun) {
    if (first % kTileWidth == 0) known.surface = -1;
    const int row = tile.top + first / kTileWidth;
    const int column = tile.left + first % kTileWidth;
    const std::int32_t* ids = Nearest(column, row);
    float* values = image.ptr<float>(row) + column;
    const bool uniform =
        ids[0] >= 0 && std::all_of(ids + 1, ids + kRun, [ids](std::int32_t id) { return id == ids[0]; });
    if (uniform) {
      const Texture& texture = *surfaces[static_cast<std::size_t>(ids[0])].texture;
      FindFilter(tile, ids[0], texture, first + kRun - 1, known);
      ShadeRun(candidates_.prepared(ids[0]), texture, known.filter, tile.x + first, tile.y + first, values);
    } else {
      ShadeSinglePixels(tile, first, surfaces, known, values);
    }
  }
  ShadeEdges(tile, FindEdges(tile), surfaces, image);
}

void Renderer::Picture::FindFilter(const TilePlace& tile, std::int32_t surface, const Texture& texture, int pixel,
                                   RowFilter& known) const {
  if (known.surface == surface) return;
  known = {surface, FilterAt(tile, surface, texture, tile.x[pixel], tile.y[pixel], kMaxProbes)};
}

void Renderer::Picture::ShadeSinglePixels(const TilePlace& tile, int first, const std::vector<Surface>& surfaces,
                                          RowFilter& known, float* values) {
  const std::int32_t* ids = Nearest(tile.left + first % kTileWidth, tile.top + first / kTileWidth);
  for (int i = 0; i < kRun; ++i) {
    values[i] = 0.0F;
    // Pixels between different neighbours are edges and drawn as such.
    if (ids[i] < 0 || ids[i] != ids[i - 1] || ids[i] != ids[i + 1]) continue;
    const Texture& texture = *surfaces[static_cast<std::size_t>(ids[i])].texture;
    FindFilter(tile, ids[i], texture, first + i, known);
    const SurfacePoint at = Meet(candidates_.prepared(ids[i]), tile.x[first + i], tile.y[first + i]);
    values[i] = SampleFiltered(texture, known.filter, at.s, at.t);
  }
}

int Renderer::Picture::FindEdges(const TilePlace& tile) {
  int count = 0;
  for (int row = 0; row < kTileHeight; ++row) {
    const std::int32_t* own = Nearest(tile.left, tile.top + row);
    const std::int32_t* above = own - stride_;
    const std::int32_t* below = own + stride_;
    std::array<bool, kTileWidth> is_edge;
    int found = 0;
    for (int i = 0; i < kTileWidth; ++i) {
      const std::int32_t change =
          (own[i] ^ own[i - 1]) | (own[i] ^ own[i + 1]) | (own[i] ^ above[i]) | (own[i] ^ below[i]);
      is_edge[static_cast<std::size_t>(i)] = change != 0;
      found |= change;
    }
    if (found == 0) continue;
    for (int i = 0; i < kTileWidth; ++i) {
      if (is_edge[static_cast<std::size_t>(i)]) edge_pixels_[static_cast<std::size_t>(count++)] = row * kTileWidth + i;
    }
  }
  return count;
}

void Renderer::Picture::ShadeEdges(const TilePlace& tile, int count, const std::vector<Surface>& surfaces,
                                   cv::Mat& image) {
  if (count == 0) return;
  for (int i = 0; i < count * kSubrays; ++i) {
    const int pixel = edge_pixels_[static_cast<std::size_t>(i / kSubrays)];
    const float column = kSubrayColumn[static_cast<std::size_t>(i % kSubrays)];
    const float row = kSubrayRow[static_cast<std::size_t>(i % kSubrays)];
    x_[static_cast<std::size_t>(i)] = tile.x[pixel] + tile.step.x_column * column + tile.step.x_row * row;
    y_[static_cast<std::size_t>(i)] = tile.y[pixel] + tile.step.y_column * column + tile.step.y_row * row;
  }
  Trace(tile.index, count * kSubrays, x_.data(), y_.data());
  // The last two surfaces' level of detail: an edge alternates between two, and a tile hardly changes it.
  std::array<std::int32_t, 2> known = {-1, -1};
  std::array<const Texture::Level*, 2> levels = {nullptr, nullptr};
  for (int edge = 0; edge < count; ++edge) {
    float sum = 0.0F;
    for (int sub = 0; sub < kSubrays; ++sub) {
      const auto ray = static_cast<std::size_t>(edge * kSubrays + sub);
      const std::int32_t id = surface_[ray];
      if (id < 0) continue;
      if (known[0] != id) {
        std::swap(known[0], known[1]);
        std::swap(levels[0], levels[1]);
      }
      if (known[0] != id) {
        const Texture& texture = *surfaces[static_cast<std::size_t>(id)].texture;
        // Finer than the whole pixel's: the rays' mean does the rest.
        const float level = FilterAt(tile, id, texture, x_[ray], y_[ray], 1).level - 0.5F;
        known[0] = id;
        levels[0] = &texture.level(std::max(static_cast<int>(level), 0));
      }
      const SurfacePoint at = Meet(candidates_.prepared(id), x_[ray], y_[ray]);
      sum += SampleBilinear(*levels[0], at.s, at.t);
    }
    const int pixel = edge_pixels_[static_cast<std::size_t>(edge)];
    image.at<float>(tile.top + pixel / kTileWidth, tile.left + pixel % kTileWidth) = sum / kSubrays;
  }
}

void Renderer::Picture::Render(const std::vector<Surface>& surfaces, const Rigid3d& camera_from_world, cv::Mat& image) {
  image.create(rays_->height, rays_->width, CV_32F);
  candidates_.Fill(surfaces, camera_from_world);
  const int tiles = rays_->tiles_across * rays_->tiles_down;
  for (int tile = 0; tile < tiles; ++tile) TraceTile(Place(tile));
  RepeatBorder();
  for (int tile = 0; tile < tiles; ++tile) ShadeTile(Place(tile), surfaces, image);
}

Renderer::Renderer(std::shared_ptr<const RayTable> rays) : picture_(std::make_unique<Picture>(std::move(rays))) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;

void Renderer::Render(const std::vector<Surface>& surfaces, const Rigid3d& camera_from_world, cv::Mat& image) {
  picture_->Render(surfaces, camera_from_world, image);
}

}  // namespace pangaea
