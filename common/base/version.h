#pragma once

namespace pangaea {

// The software's version; CMakeLists.txt has the same (a test compares them).
inline constexpr const char* kVersion = "0.1.0";

}  // namespace pangaea
