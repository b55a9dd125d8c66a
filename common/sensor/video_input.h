#pragma once

#include <filesystem>
#include <string>

#include "common/base/result.h"
#include "common/sensor/frame_stream.h"
#include "common/sensor/sensor_kind.h"

namespace pangaea {

// A video file, or a camera by its number ("0" is the first one), through OpenCV. `calibration` (camera_chain.h) is
// needed. Stereo: both images side by side in one frame, the left one first.
// Stamps: a video's own times, from 0 on, where they ascend, else its rate; a camera's by the system clock as the frame
// arrives. Fails where the source cannot be opened or its frames have not the calibrated size.
Result<CameraInput> OpenVideoInput(const std::string& file_or_number, const std::filesystem::path& calibration,
                                   SensorKind kind);

}  // namespace pangaea
