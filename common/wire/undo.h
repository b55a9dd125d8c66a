#pragma once

#include <cstdint>
#include <string>

namespace pangaea {

// An operator asks the server to take a cause back, "merge 17".
struct UndoRequest {
  std::uint64_t request = 0;  // random: answers go to all who listen
  std::string cause;
  bool operator==(const UndoRequest&) const = default;
};

struct UndoAnswer {
  std::uint64_t request = 0;
  bool done = false;
  std::string text;  // what was done, or why nothing was
  bool operator==(const UndoAnswer&) const = default;
};

}  // namespace pangaea
