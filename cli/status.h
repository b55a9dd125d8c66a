#pragma once

#include "cli/command.h"

namespace pangaea {

// `pangaea status`: shows the atlas of a site as its server publishes it, once or as it changes.
Command StatusCommand();

}  // namespace pangaea
