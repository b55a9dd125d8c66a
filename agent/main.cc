#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <opencv2/core.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "agent/runtime/agent_output.h"
#include "agent/runtime/agent_run.h"
#include "common/base/blas_threads.h"
#include "common/base/process_memory.h"
#include "common/base/stop_signals.h"
#include "common/base/version.h"

namespace pangaea {
namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

// Turns signals into requests: the first asks for an end in order, the second for one without waiting for the server.
class SignalWatch {
 public:
  SignalWatch() {
    thread_ = std::thread([this] {
      for (std::stop_source* source : {&stop_, &hurry_}) {
        signals_.Wait();
        if (over_) return;
        source->request_stop();
      }
    });
  }
  ~SignalWatch() {
    over_ = true;
    signals_.Post();
    thread_.join();
  }
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  std::stop_token stop() const { return stop_.get_token(); }
  std::stop_token hurry() const { return hurry_.get_token(); }

 private:
  StopSignals signals_;
  std::atomic<bool> over_ = false;
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
  std::string sensor = "stereo";
  std::string config;
  bool no_server = false;
};

void Describe(CLI::App& app, CommandLine& line) {
  AgentOptions& options = line.options;
  app.set_version_flag("--version", std::string("pangaea-agent ") + kVersion);
  app.add_option("--dataset", options.dataset,
                 "Folder of a recorded sequence (EuRoC, TUM-VI, KITTI odometry or TUM RGB-D)")
      ->type_name("DIR");
  app.add_option("--video", options.video, "Video file, or number of a camera (0 is the first); needs --calibration")
      ->type_name("FILE|N");
  app.add_option("--lcm", options.lcm_input,
                 "Images from LCM: udpm://239.255.76.67:7667?ttl=0 for a network, file://PATH for a log")
      ->type_name("URL");
  app.add_option("--calibration", options.calibration,
                 "YAML file that describes the cameras (a Kalibr camera chain) instead of the input's own calibration")
      ->type_name("FILE");
  app.add_option("--lcm-output", options.lcm_output, "Publish pose, tracking state and statistics on LCM, too")
      ->type_name("URL");
  app.add_option("--sensor", line.sensor,
                 "Which cameras to use: stereo, or mono (the left one alone; the map's scale is then free)")
      ->type_name("KIND")
      ->capture_default_str();
  app.add_option("--site", options.site, "The site whose server to talk to")->type_name("NAME")->capture_default_str();
  app.add_option("--name", options.name, "Name of this session for people (default: the dataset's)")->type_name("NAME");
  app.add_option("--rate", line.rate,
                 "realtime (the newest frame wins, late ones are dropped), max (as fast as possible, no frame is "
                 "dropped), or a factor of real time from 0.01 to 100, such as 0.5")
      ->type_name("RATE")
      ->capture_default_str();
  app.add_flag("--deterministic", options.deterministic,
               "Everything in order on one thread; with --rate max the same input gives the same trajectory");
  app.add_option("--seed", options.seed, "Seed of everything random")->type_name("N")->capture_default_str();
  app.add_option("--trajectory", options.trajectory,
                 "Write the body's final trajectory (TUM format); further maps go to FILE.2.tum and so on, the largest "
                 "map first")
      ->type_name("FILE.tum");
  app.add_option("--live-trajectory", options.live_trajectory,
                 "Write each frame's pose as it was known at the time (TUM format)")
      ->type_name("FILE.tum");
  app.add_option("--report", options.report, "Write counts and timings")->type_name("FILE.json");
  app.add_flag("--no-server", line.no_server, "Track and map alone");
  app.add_option("--vocabulary", options.vocabulary,
                 "Words that places are recognised by, from `pangaea vocabulary` (default: those built in)")
      ->type_name("FILE");
  app.add_option("--config", line.config, "YAML file with options; config/agent.yaml has them all, with their defaults")
      ->type_name("FILE");
  app.add_option("--domain", options.domain.id, "DDS domain, 0 to 230")->type_name("N")->capture_default_str();
  app.footer(
      "Without a server in reach the agent maps on; what no server acknowledged by the end is left in\n"
      "pangaea-SESSION.spill in the current folder. Ctrl-C ends a run in order, a second one stops waiting for the\n"
      "server. CYCLONEDDS_URI chooses the network; without it a server on this machine alone is found, over loopback.\n"
      "Exit codes: 0 done, also where no server was in reach; 1 failed, or the server refused part of the map;\n"
      "2 wrong usage or configuration.\n\n"
      "Examples:\n"
      "  pangaea-agent --dataset MH_01_easy --trajectory mh1.tum\n"
      "  pangaea-agent --dataset sequences/00 --rate max --no-server --report report.json\n"
      "  pangaea-agent --lcm udpm://239.255.76.67:7667?ttl=0 --lcm-output udpm://239.255.76.67:7667?ttl=0");
}

int Fail(const std::string& message, int code = kFailed) {
  std::cerr << "pangaea-agent: " << message << '\n';
  return code;
}

// The command line wins over the configuration file; they have no option in common.
Status Complete(CommandLine& line) {
  AgentOptions& options = line.options;
  const auto rate = ParseRate(line.rate);
  if (!rate) {
    return Fail(ErrorCode::kInvalidArgument,
                "--rate is '" + line.rate + "'; allowed: realtime, max, or a factor of 0.01 to 100");
  }
  options.rate = *rate;
  if (line.sensor != "stereo" && line.sensor != "mono") {
    return Fail(ErrorCode::kInvalidArgument, "--sensor is '" + line.sensor + "'; allowed: stereo, mono");
  }
  options.sensor = line.sensor == "mono" ? SensorKind::kMonocular : SensorKind::kStereo;
  if (Status status = options.CheckInput(); !status) return status;
  options.use_server = !line.no_server;
  if (!line.config.empty()) {
    if (Status status = ReadAgentConfig(line.config, options); !status) return status;
  }
  return options.Check();
}

int Run(CommandLine& line) {
  const AgentOptions& options = line.options;
  if (const Status status = Complete(line); !status) return Fail(status.error().message, kWrongUsage);
  spdlog::set_default_logger(spdlog::stderr_color_mt("pangaea-agent"));  // the summary alone goes to stdout
  const SignalWatch signals;
  cv::setNumThreads(1);  // the agent's own threads are all it needs; others would fight for the cores
  const auto run = RunAgent(options, signals.stop(), signals.hurry());
  if (!run && signals.stop().stop_requested()) {
    spdlog::info("stopped before the first frame: {}", run.error().message);
    return 0;
  }
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
  pangaea::ShareHeaps();
  pangaea::UseOneBlasThread();
  CLI::App app("Tracks a camera, maps locally and streams keyframes to the server that keeps the atlas.",
               "pangaea-agent");
  pangaea::CommandLine line;
  pangaea::Describe(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // Help and version are "errors" of code 0 to CLI11.
    return app.exit(error, std::cout, std::cerr) == 0 ? 0 : pangaea::kWrongUsage;
  }
  return pangaea::Run(line);
}
