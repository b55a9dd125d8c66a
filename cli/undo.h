#pragma once

#include "cli/command.h"

namespace pangaea {

// `pangaea undo`: takes back what the server did to the maps of a store.
Command UndoCommand();

}  // namespace pangaea
