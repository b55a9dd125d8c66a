#pragma once

#include <stop_token>

#include "agent/runtime/agent_options.h"
#include "common/base/result.h"
#include "common/sensor/frame_stream.h"

namespace pangaea {

// Opens what the options name: a recorded dataset, a video or camera, or LCM. A live one is waited for until `stop`.
Result<CameraInput> OpenCameraInput(const AgentOptions& options, const std::stop_token& stop);

}  // namespace pangaea
