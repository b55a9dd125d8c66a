#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/sensor/camera_rig.h"
#include "common/sensor/sensor_kind.h"

namespace pangaea {

// A rig as calibration_t, and back with exactly the same numbers.
std::vector<std::byte> EncodeCalibration(const CameraRig& rig);

// Any octets may come: what is no calibration, or an impossible one, is an error that names the member and what is
// allowed. A monocular sensor takes the left camera alone.
Result<CameraRig> DecodeCalibration(std::span<const std::byte> payload, SensorKind kind);

}  // namespace pangaea
