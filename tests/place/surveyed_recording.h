#pragma once

#include <filesystem>
#include <vector>

#include "common/base/result.h"
#include "tests/place/revisits.h"

namespace pangaea::testing {

// Every stereo pair of a recording, rectified, described and stereo-matched as an agent does, with its true pose.
Result<std::vector<SurveyedKeyframe>> ReadSurveyedKeyframes(const std::filesystem::path& folder, int features);

}  // namespace pangaea::testing
