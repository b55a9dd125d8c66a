#pragma once

#include <filesystem>

#include "common/base/result.h"
#include "common/sensor/dataset.h"

namespace pangaea {

// The ASL layout of the EuRoC dataset (Burri et al. 2016), also written by the TUM-VI one (Schubert et al. 2018):
// mav0/cam0/{data.csv,data/}, mav0/cam1 likewise, ground truth in mav0/state_groundtruth_estimate0 or mav0/mocap0.
// `folder` holds mav0, or is it. The calibration is in each camera's sensor.yaml (EuRoC) or in dso/camchain.yaml beside
// mav0 (TUM-VI); `calibration` names another file, unless it is empty.
bool IsEurocDataset(const std::filesystem::path& folder);
Result<Dataset> OpenEurocDataset(const std::filesystem::path& folder, SensorKind kind,
                                 const std::filesystem::path& calibration, GroundTruth truth);

}  // namespace pangaea
