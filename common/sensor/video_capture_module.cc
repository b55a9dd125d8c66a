#include <opencv2/videoio.hpp>
#include <utility>

#include "common/sensor/video_capture.h"

namespace pangaea {
namespace {

class OpenCvCapture final : public VideoCapture {
 public:
  explicit OpenCvCapture(cv::VideoCapture capture) : capture_(std::move(capture)) {}

  cv::Size frame_size() const override {
    return {static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH)),
            static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT))};
  }
  double frames_per_second() const override { return capture_.get(cv::CAP_PROP_FPS); }
  double position_ms() const override { return capture_.get(cv::CAP_PROP_POS_MSEC); }
  std::optional<Result<cv::Mat>> Next() override {
    try {
      cv::Mat frame;
      if (!capture_.read(frame) || frame.empty()) return std::nullopt;
      return frame;
    } catch (const std::exception& exception) {
      return Result<cv::Mat>(Fail(ErrorCode::kCorrupt, exception.what()));
    }
  }

 private:
  cv::VideoCapture capture_;
};

// Left to choose, OpenCV also asks GPhoto2 for photo cameras on USB, for files as well: it takes long and leaks what it
// finds.
#if defined(__linux__)
constexpr int kFiles = cv::CAP_FFMPEG;
constexpr int kCameras = cv::CAP_V4L2;
#else
constexpr int kFiles = cv::CAP_ANY;
constexpr int kCameras = cv::CAP_ANY;
#endif

template <typename Open>
Result<std::unique_ptr<VideoCapture>> OpenWith(const Open& open) {
  try {
    cv::VideoCapture capture;
    if (!open(capture) || !capture.isOpened()) return nullptr;
    return std::make_unique<OpenCvCapture>(std::move(capture));
  } catch (const std::exception& exception) {
    return Fail(ErrorCode::kCorrupt, exception.what());
  }
}

Result<std::unique_ptr<VideoCapture>> OpenFile(const std::string& path) {
  return OpenWith([&](cv::VideoCapture& capture) { return capture.open(path, kFiles); });
}

Result<std::unique_ptr<VideoCapture>> OpenCamera(int number, cv::Size wanted) {
  return OpenWith([&](cv::VideoCapture& capture) {
    if (!capture.open(number, kCameras)) return false;
    capture.set(cv::CAP_PROP_FRAME_WIDTH, wanted.width);
    capture.set(cv::CAP_PROP_FRAME_HEIGHT, wanted.height);
    return true;
  });
}

}  // namespace
}  // namespace pangaea

extern "C" __attribute__((visibility("default"))) const pangaea::VideoCaptures pangaea_video_capture;
const pangaea::VideoCaptures pangaea_video_capture{.open_file = &pangaea::OpenFile,
                                                   .open_camera = &pangaea::OpenCamera};
