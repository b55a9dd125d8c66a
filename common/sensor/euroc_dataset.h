#pragma once

#include <filesystem>

#include "common/base/result.h"
#include "common/sensor/dataset.h"

namespace pangaea {

// True for a folder that contains mav0, and for mav0 itself (EuRoC's ASL layout).
bool IsEurocDataset(const std::filesystem::path& folder);

// mav0/cam{0,1}/{sensor.yaml,data.csv,data/}, mav0/state_groundtruth_estimate0/data.csv (optional). The body is the
// frame that T_BS of sensor.yaml refers to.
Result<Dataset> OpenEurocDataset(const std::filesystem::path& folder, SensorKind kind);

}  // namespace pangaea
