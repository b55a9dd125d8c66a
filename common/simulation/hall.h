#pragma once

#include <cstdint>

#include "common/simulation/scene.h"

namespace pangaea {

struct HallOptions {
  std::uint64_t seed = 1;
  // Every surface of a kind shows the same picture: a place that deceives place recognition.
  bool repetitive = false;
  // Boxes as large as people that go round the hall. They are not part of the map's truth.
  int occluders = 0;
  // Texels this many times larger than cameras deserve: a coarse hall is ready sooner, for tests.
  double coarseness = 1.0;
  // Threads that paint the textures. The result does not depend on it.
  int jobs = 1;
};

// A furnished hall of 20 x 14 x 6 m: tables, shelves, crates, pillars, posters, windows, doors, lamps. No two surfaces
// look alike unless asked for. A pure function of the options.
Scene BuildHall(const HallOptions& options);

}  // namespace pangaea
