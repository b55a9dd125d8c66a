#pragma once

#include "cli/command.h"

namespace pangaea {

// `pangaea export`: writes what a store holds in formats of other programs.
Command ExportCommand();

}  // namespace pangaea
