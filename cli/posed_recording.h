#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/ideal_camera.h"
#include "common/mapping/posed_map.h"
#include "common/sensor/sensor_kind.h"

namespace pangaea {

struct PosedRecordingOptions {
  std::filesystem::path dataset;
  std::filesystem::path poses;       // TUM file of body poses; empty: the dataset's own ground truth
  std::optional<SensorKind> sensor;  // none: stereo where the recording has two cameras
  double interval_s = 0.0;           // least time between two keyframes, seconds; 0: every frame is one
};

// The frames of a recording as keyframes, with our own features and with the poses it came with.
struct PosedRecording {
  std::string name;
  SensorKind sensor = SensorKind::kStereo;
  IdealCamera camera;
  Rigid3d body_from_camera;
  std::vector<PosedKeyframe> keyframes;
  std::vector<std::string> warnings;  // what was skipped and how often, one sentence each
};

// Frames without a pose at their time, or whose left image cannot be read, are skipped with a warning; one without its
// right image has no depth. Errors: no dataset, no poses at all, or fewer than two keyframes left.
Result<PosedRecording> ReadPosedRecording(const PosedRecordingOptions& options);

}  // namespace pangaea
