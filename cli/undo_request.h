#pragma once

#include <string>

#include "common/base/result.h"
#include "common/dds/participant.h"
#include "common/wire/undo.h"

namespace pangaea {

struct UndoServer {
  std::string site;
  DomainOptions domain;
  // For finding the server, its rest from work and the rebuilding of the atlas together, seconds.
  double timeout_seconds = 60.0;
};

// Asks the running server of a site to take a cause back, and waits for its answer. kUnavailable where no server is
// found in time, or none answers.
Result<UndoAnswer> AskToUndo(const std::string& cause, const UndoServer& server);

}  // namespace pangaea
