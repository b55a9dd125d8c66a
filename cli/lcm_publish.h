#pragma once

#include "cli/command.h"

namespace pangaea {

// `pangaea lcm-publish`: plays a recording onto LCM, or writes it as an LCM log.
Command LcmPublishCommand();

}  // namespace pangaea
