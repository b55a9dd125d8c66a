#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "agent/runtime/agent_output.h"
#include "agent/runtime/agent_run.h"
#include "common/base/version.h"

namespace pangaea {
namespace {

constexpr int kFailed = 1;

// Waits for SIGINT and SIGTERM on a thread of its own; the program's other threads never see them. The first asks for
// an end in order, the second for one without waiting for the server.
class SignalWatch {
 public:
  SignalWatch() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    sigaddset(&signals_, SIGUSR1);  // our own: the watch is over
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    thread_ = std::thread([this] {
      for (std::stop_source* source : {&stop_, &hurry_}) {
        int received = 0;
        sigwait(&signals_, &received);
        if (received == SIGUSR1) return;
        source->request_stop();
      }
    });
  }
  ~SignalWatch() {
    pthread_kill(thread_.native_handle(), SIGUSR1);
    thread_.join();
  }
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  std::stop_token stop() const { return stop_.get_token(); }
  std::stop_token hurry() const { return hurry_.get_token(); }

 private:
  sigset_t signals_;
  std::stop_source stop_;
  std::stop_source hurry_;
  std::thread thread_;
};

std::optional<PlayRate> ParseRate(const std::string& text) {
  if (text == "realtime") return PlayRate{1.0};
  if (text == "max") return PlayRate{0.0};
  char* end = nullptr;
  const double factor = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0' || !(factor > 0.0)) return std::nullopt;
  return PlayRate{factor};
}

struct CommandLine {
  AgentOptions options;
  std::string rate = "realtime";
  std::string config;
  bool no_server = false;
};

void Describe(CLI::App& app, CommandLine& line) {
  AgentOptions& options = line.options;
  const std::map<std::string, SensorKind> sensors{{"stereo", SensorKind::kStereo}};
  app.set_version_flag("--version", std::string("pangaea-agent ") + kVersion);
  app.add_option("--dataset", options.dataset, "Folder of a recorded sequence (EuRoC ASL or KITTI odometry)")
      ->required();
  app.add_option("--sensor", options.sensor, "Which cameras to use: stereo")
      ->transform(CLI::CheckedTransformer(sensors, CLI::ignore_case))
      ->default_str("stereo");
  app.add_option("--site", options.site, "The site whose server to talk to")->capture_default_str();
  app.add_option("--name", options.name, "Name of this session for people (default: the dataset's)");
  app.add_option("--rate", line.rate,
                 "realtime; max (as fast as possible, no frame is dropped); or a factor such as 0.5")
      ->capture_default_str();
  app.add_flag("--deterministic", options.deterministic,
               "Everything in order on one thread: the same input gives the same trajectory");
  app.add_option("--seed", options.seed, "Seed of everything random")->capture_default_str();
  app.add_option("--trajectory", options.trajectory,
                 "Write the body's final trajectory (TUM format); OUT.2.tum and so on for further maps");
  app.add_option("--live-trajectory", options.live_trajectory,
                 "Write each frame's pose as it was known at the time (TUM format)");
  app.add_option("--report", options.report, "Write counts and timings (JSON)");
  app.add_flag("--no-server", line.no_server, "Track and map alone");
  app.add_option("--config", line.config, "Options file (see config/agent.yaml)");
  app.add_option("--domain", options.domain.id, "DDS domain, 0 to 230")->capture_default_str();
}

int Fail(const std::string& message) {
  std::cerr << "pangaea-agent: " << message << '\n';
  return kFailed;
}

int Run(CommandLine& line) {
  AgentOptions& options = line.options;
  const auto rate = ParseRate(line.rate);
  if (!rate) return Fail("--rate is '" + line.rate + "', allowed is realtime, max, or a factor of 0.01 to 100");
  options.rate = *rate;
  options.use_server = !line.no_server;
  if (!line.config.empty()) {
    if (const Status status = ReadAgentConfig(line.config, options); !status) return Fail(status.error().message);
  }
  if (const Status status = options.Check(); !status) return Fail(status.error().message);
  const SignalWatch signals;
  cv::setNumThreads(1);  // the agent's own threads are all it needs; others would fight for the cores
  const auto run = RunAgent(options, signals.stop(), signals.hurry());
  if (!run) return Fail(run.error().message);
  if (const Status status = WriteOutputs(options, *run); !status) return Fail(status.error().message);
  std::cout << SummaryOf(*run);
  if (!run->unconfirmed) return 0;
  // The rest that waits in the spill file is no failure of this run; what the server refuses is.
  if (run->unconfirmed->code == ErrorCode::kUnavailable) {
    spdlog::warn("{}", run->unconfirmed->message);
    return 0;
  }
  return Fail(run->unconfirmed->message);
}

}  // namespace
}  // namespace pangaea

int main(int argc, char** argv) {
  CLI::App app{"pangaea-agent: tracks a camera, maps locally and streams keyframes to the atlas server"};
  pangaea::CommandLine line;
  pangaea::Describe(app, line);
  CLI11_PARSE(app, argc, argv);
  return pangaea::Run(line);
}
