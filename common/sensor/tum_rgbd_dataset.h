#pragma once

#include <filesystem>

#include "common/base/result.h"
#include "common/sensor/dataset.h"

namespace pangaea {

// The layout of the TUM RGB-D benchmark (Sturm et al. 2012): rgb.txt (or an associations.txt that pairs colour and
// depth) lists the colour images, groundtruth.txt has the poses of the colour camera. Only these images are used, as
// those of a monocular sensor. Calibration: `calibration` unless it is empty, else calibration.yaml in the folder, else
// the benchmark's published values for the camera that the folder's name tells (freiburg1, freiburg2, freiburg3).
bool IsTumRgbdDataset(const std::filesystem::path& folder);
Result<Dataset> OpenTumRgbdDataset(const std::filesystem::path& folder, SensorKind kind,
                                   const std::filesystem::path& calibration, GroundTruth truth);

}  // namespace pangaea
