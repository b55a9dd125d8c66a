#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pangaea {

// One `#include "..."` of the project's own files, paths relative to the repository's root.
struct Include {
  std::string from;
  std::string to;
  int line = 0;
};

// All of them below the root's source folders.
std::vector<Include> ReadIncludes(const std::filesystem::path& root);

// What the table of docs/architecture.md forbids among them, one sentence each.
std::vector<std::string> ForbiddenIncludes(const std::vector<Include>& includes);

}  // namespace pangaea
