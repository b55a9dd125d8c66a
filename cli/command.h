#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "common/base/result.h"

namespace pangaea {

// What a subcommand does once its options are parsed. An error is printed on stderr and ends the program with exit
// code 2 when it is kInvalidArgument (the user's command line), else 1.
using CommandBody = std::function<Status()>;

// One subcommand of `pangaea`: one file of this folder returns one of these, and the table in main.cc lists it.
struct Command {
  const char* name;
  const char* summary;  // one line, shown by `pangaea --help`
  // Declares the subcommand's options on `app`. The options' storage is owned by the body that is returned (a
  // shared_ptr captured by value), since CLI11 keeps references to it until parsing is done.
  std::function<CommandBody(CLI::App& app)> declare;
};

// Runs the subcommand that the command line names. Exit codes: 0 done, 1 failed, 2 wrong usage.
int RunCommandLine(const std::vector<Command>& commands, int argc, const char* const* argv);

}  // namespace pangaea
