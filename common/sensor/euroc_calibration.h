#pragma once

#include <filesystem>

#include "common/base/result.h"
#include "common/geometry/rigid3.h"
#include "common/sensor/lens.h"

namespace pangaea {

// One camera as a sensor.yaml of the ASL layout describes it.
struct EurocCamera {
  LensModel lens;
  Rigid3d body_from_camera;
};

Result<EurocCamera> ReadEurocCamera(const std::filesystem::path& sensor_yaml);

}  // namespace pangaea
