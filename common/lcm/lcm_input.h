#pragma once

#include <filesystem>
#include <stop_token>
#include <string>

#include "common/base/result.h"
#include "common/lcm/channels.h"
#include "common/sensor/frame_stream.h"
#include "common/sensor/sensor_kind.h"

namespace pangaea {

struct LcmInputOptions {
  std::string url;  // url.h
  LcmChannels channels;
  // camera_chain.h. Empty: the calibration is that of the first message of its channel. On a network it is waited for,
  // however long it takes; a log must hold one.
  std::filesystem::path calibration;
};

// The images of an LCM network or log as a stream of frames. Images are taken from the first one after the calibration
// on (a network), or from the log's first one on.
Result<CameraInput> OpenLcmInput(const LcmInputOptions& options, SensorKind kind, const std::stop_token& stop);

}  // namespace pangaea
