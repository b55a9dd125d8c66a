#pragma once

#include <filesystem>
#include <functional>

#include "common/base/result.h"
#include "common/simulation/recording.h"

namespace pangaea {

// How many of all pictures are written; called from the writing threads, one at a time.
using WritingProgress = std::function<void(int done, int total)>;

// Writes `folder`/session_1, session_2, ... as EuRoC ASL folders (mav0/cam0, cam1, state_groundtruth_estimate0) with
// the recording's number of threads. The bytes do not depend on that number. Existing files of the same names are
// replaced. kUnavailable where the disk refuses.
Status WriteRecording(const Recording& recording, const std::filesystem::path& folder, const WritingProgress& progress);

}  // namespace pangaea
