#pragma once

#include <string>
#include <vector>

namespace pangaea::testing {

// What a command line did.
struct CommandRun {
  int exit_code = -1;
  std::string out;
  std::string err;
};

// Runs `pangaea ARGUMENTS...` in this process: the commands without simulator and network.
CommandRun RunPangaea(const std::vector<std::string>& arguments);

}  // namespace pangaea::testing
