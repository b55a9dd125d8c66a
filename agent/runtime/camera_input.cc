#include "agent/runtime/camera_input.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "common/lcm/lcm_input.h"
#include "common/sensor/dataset.h"
#include "common/sensor/video_input.h"

namespace pangaea {

Result<CameraInput> OpenCameraInput(const AgentOptions& options, const std::stop_token& stop) {
  if (!options.video.empty()) return OpenVideoInput(options.video, options.calibration, options.sensor);
  if (!options.lcm_input.empty()) {
    if (options.calibration.empty()) spdlog::info("waiting for a calibration on LCM {}", options.lcm.calibration);
    const LcmInputOptions lcm{.url = options.lcm_input, .channels = options.lcm, .calibration = options.calibration};
    return OpenLcmInput(lcm, options.sensor, stop);
  }
  auto dataset = OpenDataset(options.dataset, options.sensor, options.calibration, GroundTruth::kLeave);
  if (!dataset) return tl::make_unexpected(dataset.error());
  return InputFrom(std::move(*dataset));
}

}  // namespace pangaea
