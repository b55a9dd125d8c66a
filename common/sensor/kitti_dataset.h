#pragma once

#include <filesystem>

#include "common/base/result.h"
#include "common/sensor/dataset.h"

namespace pangaea {

// True for a folder with calib.txt, times.txt and image_0 (the odometry benchmark's layout).
bool IsKittiDataset(const std::filesystem::path& folder);

// calib.txt, times.txt, image_0/, image_1/ (stereo), poses.txt (optional). The body is the left camera, the images are
// rectified already.
Result<Dataset> OpenKittiDataset(const std::filesystem::path& folder, SensorKind kind,
                                 const std::filesystem::path& calibration, GroundTruth truth);

}  // namespace pangaea
