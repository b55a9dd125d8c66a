#pragma once

namespace pangaea {
[[noreturn]] void CheckFailed(const char* condition, const char* file, int line);
}  // namespace pangaea

// An invariant of our own code. A failure is our bug: it aborts with the place, and the journal restores the state.
#define PANGAEA_CHECK(condition) \
  (static_cast<bool>(condition) ? void(0) : ::pangaea::CheckFailed(#condition, __FILE__, __LINE__))
