#pragma once

#include "common/map/ids.h"

namespace pangaea {

// A session's id: 64 random bits of the system, never 0.
SessionId RandomSessionId();

}  // namespace pangaea
