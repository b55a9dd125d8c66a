#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

#include "agent/mapping/local_mapping_options.h"
#include "agent/runtime/frame_source.h"
#include "agent/runtime/uplink_thread.h"
#include "agent/tracking/tracking_options.h"
#include "common/base/result.h"
#include "common/dds/participant.h"
#include "common/lcm/channels.h"
#include "common/sensor/sensor_kind.h"

namespace pangaea {

// What a run of the agent is asked to do: the command line and the configuration file together.
struct AgentOptions {
  // Where images come from: exactly one of the next three.
  std::filesystem::path dataset;
  std::string video;                  // a file, or a camera's number
  std::string lcm_input;              // a URL (common/lcm/url.h)
  std::filesystem::path calibration;  // of the cameras (common/sensor/camera_chain.h); empty: the input's own
  std::string lcm_output;             // URL to publish pose, tracking state and statistics on; empty: none
  LcmChannels lcm;
  SensorKind sensor = SensorKind::kStereo;
  std::string site = "default";
  std::string name;  // for people; empty: the dataset's
  PlayRate rate;
  bool deterministic = false;  // everything on one thread, in order
  std::uint64_t seed = 1;
  bool use_server = true;
  // At the end, how long the server may take to acknowledge the last edits.
  std::chrono::milliseconds flush_patience{30000};
  // The same where no server was ever seen: longer than the network takes to find one.
  std::chrono::milliseconds discovery_patience{5000};
  // After that, how long the server may take to finish what it is correcting: the final trajectory profits.
  std::chrono::milliseconds correction_patience{60000};
  // With `deterministic`, corrections are absorbed at every so many frames alone.
  int frames_between_corrections = 100;
  std::filesystem::path vocabulary;  // empty: the one built into the program
  std::filesystem::path trajectory;  // empty: not written; likewise the next two
  std::filesystem::path live_trajectory;
  std::filesystem::path report;
  DomainOptions domain;
  TrackingOptions tracking;
  LocalMappingOptions mapping;
  UplinkOptions uplink;

  // What images come from and LCM goes to: the command line's part.
  Status CheckInput() const;
  // All the rest.
  Status Check() const;
};

// Reads config/agent.yaml-like files into the options. Unknown keys and values out of range are errors.
Status ReadAgentConfig(const std::filesystem::path& path, AgentOptions& options);

}  // namespace pangaea
