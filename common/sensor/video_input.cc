#include "common/sensor/video_input.h"

#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "common/base/text.h"
#include "common/sensor/camera_chain.h"
#include "common/sensor/image.h"
#include "common/sensor/video_capture.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;

constexpr double kNanosecondsPerMillisecond = 1e6;
constexpr double kMillisecondsPerSecond = 1e3;
constexpr double kUnknownRate = 30.0;  // frames a second, of a video that does not say
constexpr std::int64_t kLastCamera = 1000;

std::string SizeText(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

// A part of a colour or grey frame, as grey pixels of its own.
Result<cv::Mat> GrayPart(const cv::Mat& frame, const cv::Rect& part) {
  if (frame.depth() != CV_8U || (frame.channels() != 1 && frame.channels() != 3 && frame.channels() != 4)) {
    return Fail(ErrorCode::kUnsupported,
                "a frame has the pixel format " + cv::typeToString(frame.type()) + "; allowed: 8-bit grey or colour");
  }
  if ((cv::Rect({}, frame.size()) & part) != part) {
    return Fail(ErrorCode::kCorrupt, "a frame is of " + SizeText(frame.cols, frame.rows) + " pixels, too few");
  }
  if (frame.channels() == 1) return frame(part).clone();
  cv::Mat gray;
  cv::cvtColor(frame(part), gray, frame.channels() == 3 ? cv::COLOR_BGR2GRAY : cv::COLOR_BGRA2GRAY);
  return gray;
}

class VideoStream final : public FrameStream {
 public:
  VideoStream(std::unique_ptr<VideoCapture> capture, bool is_camera, const CameraRig& rig)
      : capture_(std::move(capture)), is_camera_(is_camera), left_(0, 0, rig.left.width, rig.left.height) {
    if (rig.right) right_ = cv::Rect(rig.left.width, 0, rig.right->width, rig.right->height);
    const double rate = capture_->frames_per_second();
    interval_ms_ = kMillisecondsPerSecond / (rate > 0.0 && std::isfinite(rate) ? rate : kUnknownRate);
  }

  std::optional<Result<StreamFrame>> Next(const std::stop_token& stop) override {
    if (stop.stop_requested()) return std::nullopt;
    const auto next = capture_->Next();
    if (!next) return std::nullopt;
    if (!*next) return Result<StreamFrame>(tl::make_unexpected(next->error()));
    const cv::Mat& frame = **next;
    StreamFrame images{Stamp(), [frame, part = left_] { return GrayPart(frame, part); }, {}};
    if (right_) images.right = [frame, part = *right_] { return GrayPart(frame, part); };
    return images;
  }
  bool is_live() const override { return is_camera_; }

 private:
  std::int64_t Stamp() {
    if (is_camera_) {
      const auto now = std::chrono::system_clock::now().time_since_epoch();
      return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
    }
    const double own_ms = capture_->position_ms();
    const bool ascends = std::isfinite(own_ms) && own_ms >= 0.0 && (!latest_ms_ || own_ms > *latest_ms_);
    latest_ms_ = ascends ? own_ms : latest_ms_.value_or(-interval_ms_) + interval_ms_;
    return std::llround(*latest_ms_ * kNanosecondsPerMillisecond);
  }

  const std::unique_ptr<VideoCapture> capture_;
  const bool is_camera_;
  cv::Rect left_;
  std::optional<cv::Rect> right_;
  double interval_ms_ = 0.0;
  std::optional<double> latest_ms_;  // of a video
};

// The size of a whole frame.
cv::Size FrameSize(const CameraRig& rig) {
  return {rig.left.width + (rig.right ? rig.right->width : 0), rig.left.height};
}

std::optional<int> CameraNumber(const std::string& text) {
  const auto number = ParseInteger(text);
  if (!number || *number < 0 || *number > kLastCamera) return std::nullopt;
  return static_cast<int>(*number);
}

Result<std::unique_ptr<VideoCapture>> OpenCapture(const std::string& source, std::optional<int> camera,
                                                  cv::Size wanted) {
  std::error_code error;
  if (!camera && !fs::is_regular_file(source, error)) {
    return Fail(ErrorCode::kNotFound, source + ": there is no such video; allowed: a file, or a camera's number");
  }
  const auto captures = OpenVideoCaptures();
  if (!captures) return Fail(captures.error().code, source + ": " + captures.error().message);
  auto capture = camera ? (*captures)->open_camera(*camera, wanted) : (*captures)->open_file(source);
  if (!capture) return Fail(capture.error().code, source + ": " + capture.error().message);
  if (*capture) return capture;
  return Fail(camera ? ErrorCode::kUnavailable : ErrorCode::kCorrupt,
              camera ? "camera " + source + " cannot be opened" : source + ": not a video that can be read");
}

}  // namespace

Result<CameraInput> OpenVideoInput(const std::string& source, const fs::path& calibration, SensorKind kind) {
  if (calibration.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "a video needs a calibration file that describes its camera");
  }
  auto rig = ReadCameraChain(calibration, kind);
  if (!rig) return tl::make_unexpected(rig.error());
  std::error_code error;
  const auto camera = fs::exists(source, error) ? std::nullopt : CameraNumber(source);
  const cv::Size wanted = FrameSize(*rig);
  auto capture = OpenCapture(source, camera, wanted);
  if (!capture) return tl::make_unexpected(capture.error());
  const cv::Size size = (*capture)->frame_size();
  if (size != wanted) {
    return Fail(ErrorCode::kInvalidArgument,
                calibration.string() + ": cam0.resolution asks for frames of " + SizeText(wanted.width, wanted.height) +
                    (rig->right ? " (both images side by side)" : "") + ", but those of " + source + " are " +
                    SizeText(size.width, size.height) + "; allowed: the size of the frames");
  }
  CameraInput input;
  input.name = camera ? "camera_" + source : fs::path(source).stem().string();
  input.kind = camera ? "a camera" : "a video";
  input.rig = std::move(*rig);
  input.frames = std::make_unique<VideoStream>(std::move(*capture), camera.has_value(), input.rig);
  return input;
}

}  // namespace pangaea
