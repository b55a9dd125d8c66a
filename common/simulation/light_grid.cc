#include "common/simulation/light_grid.h"

#include <algorithm>
#include <cstdint>

namespace pangaea {

void ApplyLight(Canvas& canvas, const LightGrid& light) {
  const auto value = [&light](int column, int row) {
    return light.values[static_cast<std::size_t>(row * light.columns + column)];
  };
  std::vector<float> along(static_cast<std::size_t>(light.columns));
  for (int y = 0; y < canvas.height(); ++y) {
    const float v =
        (static_cast<float>(y) + 0.5F) / static_cast<float>(canvas.height()) * static_cast<float>(light.rows - 1);
    const int row = std::min(static_cast<int>(v), std::max(light.rows - 2, 0));
    const int next_row = std::min(row + 1, light.rows - 1);
    for (int column = 0; column < light.columns; ++column) {
      const float from = value(column, row);
      along[static_cast<std::size_t>(column)] = from + (v - static_cast<float>(row)) * (value(column, next_row) - from);
    }
    std::uint8_t* texel = canvas.texels().data() + static_cast<std::ptrdiff_t>(y) * canvas.width();
    const float step = static_cast<float>(light.columns - 1) / static_cast<float>(canvas.width());
    for (int x = 0; x < canvas.width(); ++x) {
      const float u = (static_cast<float>(x) + 0.5F) * step;
      const int column = std::min(static_cast<int>(u), std::max(light.columns - 2, 0));
      const float from = along[static_cast<std::size_t>(column)];
      const float to = along[static_cast<std::size_t>(std::min(column + 1, light.columns - 1))];
      const float lit = static_cast<float>(texel[x]) * (from + (u - static_cast<float>(column)) * (to - from));
      texel[x] = static_cast<std::uint8_t>(std::min(lit + 0.5F, 255.0F));
    }
  }
}

}  // namespace pangaea
