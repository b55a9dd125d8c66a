#pragma once

#include "cli/command.h"

namespace pangaea {

// `pangaea digest`: the digests of the maps and sessions in a store, to compare with those of agents or another store.
Command DigestCommand();

}  // namespace pangaea
