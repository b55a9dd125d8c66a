#pragma once

#include "cli/command.h"

namespace pangaea {

// `pangaea evaluate`: how far trajectories are from where the camera really was, from files or from a store.
Command EvaluateCommand();

}  // namespace pangaea
