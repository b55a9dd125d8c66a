#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/sensor/camera_rig.h"
#include "common/sensor/dataset.h"

namespace pangaea {

// Gives one image as its camera took it, 8-bit grey and of the calibrated size, or says why there is none. Decoding
// happens here and not before: most right images are never asked for. Any thread.
using ImageLoader = std::function<Result<cv::Mat>()>;

// The images of one instant.
struct StreamFrame {
  std::int64_t stamp_ns = 0;
  ImageLoader left;
  ImageLoader right;  // empty for a monocular sensor
};

// Where frames come from, one after the other: a folder, a video, a camera, messages. One owner thread.
class FrameStream {
 public:
  virtual ~FrameStream() = default;

  // The next frame, or why what came in its place is none (it is skipped and counted). Nothing after the last one, and
  // nothing once `stop` is requested. Stamps are as they come: not necessarily ascending.
  virtual std::optional<Result<StreamFrame>> Next(const std::stop_token& stop) = 0;
  // Frames come in their own time and wait for nobody; those of a recording come when they are asked for.
  virtual bool is_live() const = 0;
  // Of the whole stream, where that is known from the start.
  virtual std::optional<std::size_t> frame_count() const { return std::nullopt; }
  // Frames that were sent and never arrived, so far, as far as the stream can tell.
  virtual std::size_t missing() const { return 0; }
};

// A stream and the cameras that it comes from.
struct CameraInput {
  std::string name;  // for people
  std::string kind;  // "EuRoC layout", "video", ...
  CameraRig rig;
  std::unique_ptr<FrameStream> frames;
  // What was skipped so far and how often, one sentence each.
  std::vector<std::string> warnings;
};

CameraInput InputFrom(Dataset dataset);

}  // namespace pangaea
