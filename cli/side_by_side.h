#pragma once

#include <vector>

#include "common/evaluation/plot.h"

namespace pangaea {

// One scene of several whose frames have nothing to do with each other: each is levelled (`up` of each is known),
// turned so that its longest extent lies across, and put where it overlaps no other. A single scene stays as it is.
// Titles are the first one's.
PlotScene PlaceSideBySide(std::vector<PlotScene> scenes);

}  // namespace pangaea
