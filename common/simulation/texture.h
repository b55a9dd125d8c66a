#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pangaea {

// A grey picture on a rectangle with its reductions by 2, 4, ... (Williams 1983), so that it can be sampled at any
// distance without aliasing. Texel (i, j) of level l covers the square from (i, j) to (i + 1, j + 1) in units of 2^l
// level-0 texels: levels are aligned exactly, because sizes are multiples of 2^(levels - 1).
class Texture {
 public:
  struct Level {
    int width = 0;   // texels
    int height = 0;  // texels
    int stride = 0;  // bytes from row to row
    // Texel (0, 0); a border of one replicated texel surrounds the level, so that bilinear reads need no clamping.
    const std::uint8_t* origin = nullptr;
  };

  Texture() = default;
  // `texels` row-major, width x height. Width and height must be multiples of 2^(levels - 1).
  Texture(int width, int height, int levels, const std::vector<std::uint8_t>& texels);
  Texture(Texture&&) = default;
  Texture& operator=(Texture&&) = default;
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }
  int level_count() const { return static_cast<int>(levels_.size()); }
  const Level& level(int index) const { return levels_[static_cast<std::size_t>(index)]; }
  std::uint8_t Texel(int x, int y) const { return levels_.front().origin[y * levels_.front().stride + x]; }

 private:
  std::vector<std::uint8_t> storage_;
  std::vector<Level> levels_;
};

}  // namespace pangaea
