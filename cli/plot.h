#pragma once

#include "cli/command.h"

namespace pangaea {

// `pangaea plot`: a picture of an atlas, or of trajectories, from above.
Command PlotCommand();

}  // namespace pangaea
