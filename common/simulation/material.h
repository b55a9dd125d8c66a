#pragma once

#include <cstdint>
#include <memory>

#include "common/simulation/light_grid.h"
#include "common/simulation/texture.h"

namespace pangaea {

enum class Material {
  kPlaster,
  kFloor,
  kCeiling,
  kConcrete,
  kWood,
  kCarton,
  kMetal,
  kFabric,
  kBook,
  kPoster,
  kWindow,
  kDoor,
  kLamp,
};

// A picture of a material of `size_x` x `size_y` metres with texels of about `texel` metres, already lit. Shapes of all
// sizes lie over each other, as in natural pictures (the "dead leaves" of Matheron 1968), so that corners are found
// from any distance. Different seeds give different pictures.
std::shared_ptr<const Texture> PaintMaterial(Material material, std::uint64_t seed, double size_x, double size_y,
                                             double texel, const LightGrid& light);

}  // namespace pangaea
