#pragma once

#include "cli/command.h"

namespace pangaea {

// `pangaea import-keyframes`: a map of keyframes whose poses are known, as a session of a store.
Command ImportKeyframesCommand();

}  // namespace pangaea
