#pragma once

#include <vector>

#include "common/simulation/canvas.h"

namespace pangaea {

// How bright a surface is lit, on a grid of columns x rows whose outer samples lie on the surface's edges.
struct LightGrid {
  int columns = 1;
  int rows = 1;
  std::vector<float> values;  // factor on the material's grey levels, row by row
};

// Multiplies a picture that covers the whole surface by the light, interpolated.
void ApplyLight(Canvas& canvas, const LightGrid& light);

}  // namespace pangaea
