#pragma once

#include <string>
#include <vector>

#include "common/map/atlas.h"

namespace pangaea {

// Everything in which the atlas contradicts itself, in words; empty for what Apply leaves behind. Checks relations from
// both sides, recomputes covisibility and counts: costs about as much as building the atlas.
std::vector<std::string> CheckConsistency(const Atlas& atlas);

}  // namespace pangaea
