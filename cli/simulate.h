#pragma once

#include "cli/command.h"

namespace pangaea {

// `pangaea simulate`: renders flights through a hall and writes them as EuRoC ASL folders.
Command SimulateCommand();

}  // namespace pangaea
