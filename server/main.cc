#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <string>

#include "common/base/blas_threads.h"
#include "common/base/mutex.h"
#include "common/base/process_memory.h"
#include "common/base/stop_signals.h"
#include "server/runtime/server.h"

#ifndef PANGAEA_VERSION
#error "the build defines PANGAEA_VERSION"
#endif

namespace pangaea {
namespace {

constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;

// What the command line sets; it wins over the configuration file.
struct CommandLine {
  std::string config;
  std::optional<std::string> site;
  std::optional<std::string> store;
  std::optional<std::uint32_t> domain;
  std::optional<std::string> log_level;
  bool no_recognition = false;
};

void Declare(CLI::App& app, CommandLine& line) {
  app.set_version_flag("--version", "pangaea-server " PANGAEA_VERSION);
  app.add_option("--site", line.site, "Name of the site whose atlas this is (default: default)");
  app.add_option("--store", line.store, "File that holds the atlas; created where there is none (default: atlas.db)");
  app.add_option("--config", line.config, "YAML file with options; see config/server.yaml. The command line wins");
  app.add_option("--domain", line.domain, "DDS domain, 0 to 230 (default: 0)");
  app.add_option("--log-level", line.log_level, "trace, debug, info, warn, error or off (default: info)");
  app.add_flag("--no-recognition", line.no_recognition,
               "Leave maps as their agents made them: no merges, no loops, no optimisation");
  app.footer(
      "Runs until SIGTERM or SIGINT (exit code 0). CYCLONEDDS_URI chooses the network; without it agents on this\n"
      "machine alone are served, over loopback. Look at the atlas with: pangaea status --watch");
}

Result<ServerOptions> OptionsOf(const CommandLine& line) {
  ServerOptions options;
  if (!line.config.empty()) {
    if (auto status = LoadServerOptions(line.config, options); !status) return tl::make_unexpected(status.error());
  }
  if (line.site) options.site = *line.site;
  if (line.store) options.store = *line.store;
  if (line.domain) options.domain.id = *line.domain;
  if (line.log_level) options.log_level = *line.log_level;
  if (line.no_recognition) options.work.enabled = false;
  if (auto status = options.Check(); !status) return tl::make_unexpected(status.error());
  return options;
}

// Why the server stops by itself, if it does.
class Failure {
 public:
  explicit Failure(StopSignals& signals) : signals_(signals) {}

  // Any thread. Ends the wait in main the way an operator would.
  void Report(const Error& error) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    message_ = error.message;
    signals_.Post();
  }
  std::string message() const EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    return message_;
  }

 private:
  StopSignals& signals_;
  mutable Mutex mutex_;
  std::string message_ GUARDED_BY(mutex_);
};

int Serve(const ServerOptions& options) {
  StopSignals signals;
  Failure failure(signals);
  auto server = Server::Start(options, [&failure](const Error& error) { failure.Report(error); });
  if (!server) {
    std::cerr << "pangaea-server: " << server.error().message << "\n";
    return kExitFailed;
  }
  signals.Wait();
  spdlog::info("stopping");
  server->reset();
  if (failure.message().empty()) return 0;
  std::cerr << "pangaea-server: " << failure.message() << "\n";
  return kExitFailed;
}

int Main(int argc, char** argv) {
  CLI::App app("Keeps the atlas of a site: takes what agents map, keeps it durably, and shows it.", "pangaea-server");
  CommandLine line;
  Declare(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error, std::cout, std::cerr) == 0 ? 0 : kExitUsage;
  }
  const auto options = OptionsOf(line);
  if (!options) {
    std::cerr << "pangaea-server: " << options.error().message << "\n";
    return kExitUsage;
  }
  spdlog::set_level(spdlog::level::from_str(options->log_level));
  return Serve(*options);
}

}  // namespace
}  // namespace pangaea

int main(int argc, char** argv) {
  pangaea::ShareHeaps();
  pangaea::UseOneBlasThread();
  return pangaea::Main(argc, argv);
}
