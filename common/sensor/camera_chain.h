#pragma once

#include <filesystem>

#include "common/base/result.h"
#include "common/sensor/camera_rig.h"
#include "common/sensor/sensor_kind.h"

namespace pangaea {

// Reads a calibration file: the camera chain that Kalibr writes (camchain.yaml), one camera (cam0) or two (cam0 the
// left, cam1 the right one). docs/config.md lists the keys. A monocular sensor needs cam0 alone. Errors name file,
// line, key and what is allowed.
Result<CameraRig> ReadCameraChain(const std::filesystem::path& file, SensorKind kind);

// A rig of images that are rectified already: the right camera equals the left one, without distortion, displaced along
// +x alone. The message says what it is instead.
Status CheckRectified(const CameraRig& rig);

}  // namespace pangaea
