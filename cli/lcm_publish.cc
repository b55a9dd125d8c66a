#include "cli/lcm_publish.h"

#include <chrono>
#include <iostream>
#include <memory>
#include <string>

#include "common/base/stop_signals.h"
#include "common/lcm/recording_publisher.h"
#include "common/lcm/url.h"
#include "common/sensor/dataset.h"

namespace pangaea {
namespace {

struct PublishArguments {
  std::string dataset;
  std::string calibration;
  std::string url;
  std::string sensor = "stereo";
  double rate = 1.0;
  RecordingPublisher::Options options;
};

// When a frame is due.
std::chrono::nanoseconds Due(std::int64_t elapsed_ns, double rate) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(static_cast<double>(elapsed_ns) / rate));
}

Status Publish(const PublishArguments& arguments) {
  if (Status checked = arguments.options.channels.Check(); !checked) return checked;
  const auto url = LcmUrl::Parse(arguments.url);
  if (!url) return tl::make_unexpected(url.error());
  const SensorKind kind = arguments.sensor == "mono" ? SensorKind::kMonocular : SensorKind::kStereo;
  const auto dataset = OpenDataset(arguments.dataset, kind, arguments.calibration, GroundTruth::kLeave);
  if (!dataset) return tl::make_unexpected(dataset.error());
  for (const std::string& warning : dataset->warnings) std::cerr << warning << "\n";
  const auto sender = LcmSender::Open(*url);
  if (!sender) return tl::make_unexpected(sender.error());
  RecordingPublisher publisher(*dataset, **sender, arguments.options);
  StopSignals signals;
  const auto start = std::chrono::steady_clock::now();
  for (const DatasetFrame& frame : dataset->frames) {
    // A log is written as fast as it can be: its stamps are the recording's.
    const auto due = (*sender)->is_live() ? Due(frame.stamp_ns - dataset->frames.front().stamp_ns, arguments.rate)
                                          : std::chrono::nanoseconds(0);
    if (signals.WaitUntil(start + due)) break;
    if (Status status = publisher.Publish(frame); !status) return status;
  }
  if (Status closed = (*sender)->Close(); !closed) return closed;
  std::cout << "published " << publisher.published() << " of " << dataset->frames.size() << " frames\n";
  if (publisher.skipped() > 0) {
    std::cerr << publisher.skipped() << " frames skipped; the first: " << publisher.warning() << "\n";
  }
  return {};
}

void DeclareOptions(CLI::App& app, PublishArguments& arguments) {
  LcmChannels& channels = arguments.options.channels;
  app.add_option("dataset", arguments.dataset, "The recording's folder (EuRoC, TUM-VI, KITTI, TUM RGB-D)")->required();
  app.add_option("--lcm", arguments.url,
                 "Where to: udpm://239.255.76.67:7667?ttl=0 plays it in its own time, file://PATH writes a log at once")
      ->required();
  app.add_option("--sensor", arguments.sensor, "stereo or mono")
      ->check(CLI::IsMember({"stereo", "mono"}))
      ->capture_default_str();
  app.add_option("--rate", arguments.rate, "Factor of the recording's own speed")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  app.add_option("--calibration", arguments.calibration, "Camera chain (YAML) in place of the recording's own");
  app.add_option("--images", channels.images, "Channel of the image pairs, of the single images, or of the left ones")
      ->capture_default_str();
  app.add_option("--right-images", channels.right_images, "Channel of the right images, apart from the left ones");
  app.add_option("--calibration-channel", channels.calibration, "Channel of the calibration, sent once a second")
      ->capture_default_str();
  app.add_flag("--files", arguments.options.send_files, "Send the image files as they are instead of pixels");
}

}  // namespace

Command LcmPublishCommand() {
  return {"lcm-publish", "Play a recording onto LCM as a camera would, or write it as an LCM log",
          [](CLI::App& app) -> CommandBody {
            auto arguments = std::make_shared<PublishArguments>();
            DeclareOptions(app, *arguments);
            return [arguments] { return Publish(*arguments); };
          }};
}

}  // namespace pangaea
