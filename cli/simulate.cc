#include "cli/simulate.h"

namespace pangaea {

Command SimulateCommand() {
  return {"simulate", "Render flights through a furnished hall as EuRoC folders with exact ground truth",
          [](CLI::App&) -> CommandBody { return [] { return Status(); }; }};
}

}  // namespace pangaea
