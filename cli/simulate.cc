#include "cli/simulate.h"

#include <unistd.h>

#include <iostream>
#include <memory>
#include <string>
#include <thread>

#include "common/simulation/recording_writer.h"

namespace pangaea {
namespace {

struct SimulateArguments {
  std::string out;
  std::string sensor = "stereo";
  std::vector<std::string> blackouts;
  RecordingOptions options;
};

Result<std::pair<double, double>> ParseBlackout(const std::string& text) {
  const std::size_t colon = text.find(':');
  try {
    if (colon != std::string::npos)
      return std::pair(std::stod(text.substr(0, colon)), std::stod(text.substr(colon + 1)));
  } catch (const std::exception&) {  // not numbers: the same complaint as below
  }
  return Fail(ErrorCode::kInvalidArgument, "--blackout " + text + ": expected FROM:TO in seconds, for example 5:7");
}

void ShowProgress(int done, int total) {
  // A terminal gets one line that counts, a log file ten lines.
  const bool terminal = isatty(STDERR_FILENO) != 0;
  const int every = terminal ? 20 : std::max(total / 10, 1);
  if (done % every != 0 && done != total) return;
  std::cerr << (terminal ? "\r" : "") << "rendered " << done << " of " << total << " frames"
            << (terminal && done != total ? "" : "\n") << std::flush;
}

Status Simulate(SimulateArguments arguments) {
  RecordingOptions& options = arguments.options;
  options.sensor = arguments.sensor == "mono" ? SensorKind::kMonocular : SensorKind::kStereo;
  for (const std::string& text : arguments.blackouts) {
    const auto blackout = ParseBlackout(text);
    if (!blackout) return tl::make_unexpected(blackout.error());
    options.blackouts.push_back(*blackout);
  }
  if (Status checked = options.Check(); !checked) return checked;
  const Recording recording(options);
  if (Status written = WriteRecording(recording, arguments.out, ShowProgress); !written) return written;
  for (int session = 1; session <= options.sessions; ++session) {
    std::cout << (std::filesystem::path(arguments.out) / ("session_" + std::to_string(session))).string() << "\n";
  }
  return {};
}

void DeclareOptions(CLI::App& app, SimulateArguments& arguments) {
  RecordingOptions& options = arguments.options;
  options.jobs = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
  app.add_option("--out", arguments.out, "Folder for session_1, session_2, ... (EuRoC ASL layout)")->required();
  app.add_option("--sessions", options.sessions, "Flights through the same hall")->capture_default_str();
  app.add_option("--seconds", options.seconds, "Length of each flight")->capture_default_str();
  app.add_option("--laps", options.laps, "How often it is flown, to and fro, with the pictures of the first time")
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Hall, flights and noise: the same seed gives the same files")
      ->capture_default_str();
  app.add_option("--rate", options.rate, "Images a second")->capture_default_str();
  app.add_option("--sensor", arguments.sensor, "stereo or mono")
      ->check(CLI::IsMember({"stereo", "mono"}))
      ->capture_default_str();
  app.add_option("--speed", options.speed, "Mean speed, metres a second")->capture_default_str();
  app.add_option("--blur", options.blur, "Motion blur: pictures averaged over the exposure, 1 is none")
      ->capture_default_str();
  app.add_option("--exposure-drift", options.exposure_drift, "Swing of the exposure, as a share of it")
      ->capture_default_str();
  app.add_option("--blackout", arguments.blackouts, "FROM:TO in seconds: the pictures show dark noise (repeatable)");
  app.add_option("--occluders", options.occluders, "Boxes of the size of people that walk about")
      ->capture_default_str();
  app.add_flag("--repetitive", options.repetitive, "Surfaces of a kind all look the same");
  app.add_option("--jobs", options.jobs, "Threads; the files do not depend on it")->capture_default_str();
}

}  // namespace

Command SimulateCommand() {
  return {"simulate", "Render flights through a furnished hall as EuRoC folders with exact ground truth",
          [](CLI::App& app) -> CommandBody {
            auto arguments = std::make_shared<SimulateArguments>();
            DeclareOptions(app, *arguments);
            return [arguments] { return Simulate(*arguments); };
          }};
}

}  // namespace pangaea
