#pragma once

#include <string>

#include "common/base/config.h"
#include "common/geometry/rigid3.h"
#include "common/sensor/lens.h"

namespace pangaea {

// How a calibration file calls the parts of a lens model.
struct LensKeys {
  std::string camera_model = "camera_model";  // may be missing: pinhole
  std::string resolution = "resolution";
  std::string intrinsics = "intrinsics";
  std::string distortion_model = "distortion_model";
  std::string distortion_coefficients = "distortion_coefficients";
};

// Reads a lens: "pinhole" with radial-tangential, equidistant or no distortion. What is wrong the reader's Finish says.
void RequireLens(ConfigReader& reader, const LensKeys& keys, LensModel& lens);

// Reads a rigid motion written as a 4 x 4 matrix, row by row.
void RequirePose(ConfigReader& reader, const std::string& key, Rigid3d& pose);

}  // namespace pangaea
