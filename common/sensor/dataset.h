#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/stamped_pose.h"
#include "common/sensor/camera_rig.h"
#include "common/sensor/sensor_kind.h"

namespace pangaea {

// The images of one instant. The files need not exist: reading them says so.
struct DatasetFrame {
  std::int64_t stamp_ns = 0;
  // Texts: a std::filesystem::path keeps all its components, a kilobyte each, and an hour has 144,000 files.
  std::string left;
  std::string right;  // empty for a monocular sensor
};

// A recorded sequence: everything but the pixels.
struct Dataset {
  std::string name;    // of its folder
  std::string layout;  // "EuRoC", "TUM-VI", "KITTI" or "TUM RGB-D"
  CameraRig rig;
  std::vector<DatasetFrame> frames;       // ascending by stamp, stamps differ
  std::vector<StampedPose> ground_truth;  // of the body; ascending by stamp; empty where the dataset has none
  // What was skipped and how often, one sentence each.
  std::vector<std::string> warnings;
};

// Who only tracks leaves the ground truth alone: an hour of it at 200 Hz is a text of 136 MB.
enum class GroundTruth { kRead, kLeave };

// Recognises the layout of a folder and reads its calibration, frame list and ground truth. Frames that are out of
// order, or have no partner in the other camera, are left out with one warning and a count each; a calibration that is
// missing or impossible is an error with file, line, key and allowed range. `calibration` (camera_chain.h) takes the
// place of the folder's own, unless it is empty.
Result<Dataset> OpenDataset(const std::filesystem::path& folder, SensorKind kind,
                            const std::filesystem::path& calibration = {}, GroundTruth truth = GroundTruth::kRead);

}  // namespace pangaea
