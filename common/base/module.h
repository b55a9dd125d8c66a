#pragma once

#include <filesystem>

#include "common/base/result.h"

namespace pangaea {

// A module is a part of the program in a shared library of its own, which is opened only by a run that needs it: the
// libraries behind it would cost every process memory and time to start (docs/decisions/0023-modules.md). It gives one
// table of functions, a constant object with C linkage:
//
//   struct Table {
//     static constexpr const char* kFile = "pangaea_something.so";
//     static constexpr const char* kSymbol = "pangaea_something";  // the name of the object
//     static constexpr int kVersion = 1;                           // raised with every change of the table
//     int version = kVersion;                                      // the first member
//     Result<int> (*function)(...);
//   };
//
// Program and module come from one build, so values of C++ may cross. Exceptions may not.

// Where the modules of the running program are: the folder `lib` beside the folder that the program is in.
std::filesystem::path ModuleFolder();

// The table `symbol` of the module `path`, which stays open as long as the process runs. A file that is missing, that
// is no module of ours or one of another version is an error that names it and what is wrong. Any thread.
Result<const void*> OpenModuleTable(const std::filesystem::path& path, const char* symbol, int version);

template <typename Table>
Result<const Table*> OpenModule(const std::filesystem::path& folder) {
  return OpenModuleTable(folder / Table::kFile, Table::kSymbol, Table::kVersion).map([](const void* table) {
    return static_cast<const Table*>(table);
  });
}

}  // namespace pangaea
