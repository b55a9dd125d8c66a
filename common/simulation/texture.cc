#include "common/simulation/texture.h"

#include <algorithm>
#include <cstring>

#include "common/base/check.h"

namespace pangaea {
namespace {

// The mean of each square of 2 x 2 texels of `source`, rounded to nearest.
void ReduceByTwo(const Texture::Level& source, int width, int height, int stride, std::uint8_t* target) {
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* upper = source.origin + 2 * y * source.stride;
    const std::uint8_t* lower = upper + source.stride;
    for (int x = 0; x < width; ++x) {
      const int sum = upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1];
      target[y * stride + x] = static_cast<std::uint8_t>((sum + 2) >> 2);
    }
  }
}

void ReplicateBorder(int width, int height, int stride, std::uint8_t* origin) {
  for (int y = 0; y < height; ++y) {
    origin[y * stride - 1] = origin[y * stride];
    origin[y * stride + width] = origin[y * stride + width - 1];
  }
  const auto row_bytes = static_cast<std::size_t>(width) + 2;
  std::memcpy(origin - stride - 1, origin - 1, row_bytes);
  std::memcpy(origin + height * stride - 1, origin + (height - 1) * stride - 1, row_bytes);
}

}  // namespace

Texture::Texture(int width, int height, int levels, const std::vector<std::uint8_t>& texels) {
  const int multiple = 1 << (levels - 1);
  PANGAEA_CHECK(levels > 0 && width > 0 && height > 0 && width % multiple == 0 && height % multiple == 0);
  PANGAEA_CHECK(texels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::size_t bytes = 0;
  for (int l = 0; l < levels; ++l) {
    bytes += static_cast<std::size_t>((width >> l) + 2) * static_cast<std::size_t>((height >> l) + 2);
  }
  storage_.resize(bytes);
  std::size_t offset = 0;
  for (int l = 0; l < levels; ++l) {
    const int level_width = width >> l;
    const int level_height = height >> l;
    const int stride = level_width + 2;
    std::uint8_t* origin = storage_.data() + offset + stride + 1;
    if (l == 0) {
      for (int y = 0; y < height; ++y) {
        std::copy_n(texels.begin() + static_cast<std::ptrdiff_t>(y) * width, width, origin + y * stride);
      }
    } else {
      ReduceByTwo(levels_.back(), level_width, level_height, stride, origin);
    }
    ReplicateBorder(level_width, level_height, stride, origin);
    levels_.push_back({level_width, level_height, stride, origin});
    offset += static_cast<std::size_t>(stride) * static_cast<std::size_t>(level_height + 2);
  }
}

}  // namespace pangaea
