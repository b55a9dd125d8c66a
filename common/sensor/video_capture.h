#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

#include "common/base/result.h"

namespace pangaea {

// A video or a camera that is open. One owner thread.
class VideoCapture {
 public:
  virtual ~VideoCapture() = default;

  virtual cv::Size frame_size() const = 0;            // pixels
  virtual double frames_per_second() const = 0;       // as the source says: anything where it does not know
  virtual double position_ms() const = 0;             // of the latest frame in its video: likewise
  virtual std::optional<Result<cv::Mat>> Next() = 0;  // grey or colour (BGR, BGRA); nothing after the last frame
};

// The module with OpenCV's videos and cameras, and two hundred libraries behind them (common/base/module.h).
struct VideoCaptures {
  static constexpr const char* kFile = "pangaea_video_capture.so";
  static constexpr const char* kSymbol = "pangaea_video_capture";
  static constexpr int kVersion = 1;

  int version = kVersion;
  // A video file, or a camera that is asked for frames of the size `wanted`; null where OpenCV cannot open it. Any
  // thread.
  Result<std::unique_ptr<VideoCapture>> (*open_file)(const std::string& path);
  Result<std::unique_ptr<VideoCapture>> (*open_camera)(int number, cv::Size wanted);
};

// Opened by the first caller, while others wait. Any thread.
Result<const VideoCaptures*> OpenVideoCaptures();

}  // namespace pangaea
