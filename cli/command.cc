#include "cli/command.h"

#include <iostream>
#include <vector>

#ifndef PANGAEA_VERSION
#error "the build defines PANGAEA_VERSION"
#endif

namespace pangaea {
namespace {

constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;

int Run(const char* name, const CommandBody& body) {
  const Status status = body();
  if (status) return 0;
  std::cerr << "pangaea " << name << ": " << status.error().message << "\n";
  return status.error().code == ErrorCode::kInvalidArgument ? kExitUsage : kExitFailed;
}

}  // namespace

int RunCommandLine(const std::vector<Command>& commands, int argc, const char* const* argv) {
  CLI::App app("Pangaea: collaborative, multi-session visual SLAM. Tools around agents and server.", "pangaea");
  app.set_version_flag("--version", "pangaea " PANGAEA_VERSION);
  app.require_subcommand(1);
  std::vector<std::pair<CLI::App*, CommandBody>> bodies;
  for (const Command& command : commands) {
    CLI::App* subcommand = app.add_subcommand(command.name, command.summary);
    bodies.emplace_back(subcommand, command.declare(*subcommand));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // Help and version are "errors" of code 0 to CLI11.
    return app.exit(error, std::cout, std::cerr) == 0 ? 0 : kExitUsage;
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].first->parsed()) return Run(commands[i].name, bodies[i].second);
  }
  return kExitUsage;
}

}  // namespace pangaea
