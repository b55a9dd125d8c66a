#include <opencv2/imgcodecs.hpp>
#include <string>

#include "common/sensor/image_decoder.h"

namespace pangaea {
namespace {

Result<cv::Mat> DecodeGray(std::span<const std::byte> file) {
  try {
    // OpenCV lists its codecs when the first is asked for: one thread does that, and the others wait for it here.
    [[maybe_unused]] static const bool kCodecsListed = cv::haveImageWriter(".png");
    const cv::Mat raw(1, static_cast<int>(file.size()), CV_8UC1, const_cast<std::byte*>(file.data()));
    cv::Mat image = cv::imdecode(raw, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
    if (image.empty()) return Fail(ErrorCode::kCorrupt, "corrupt: the pixels cannot be decoded");
    return image;
  } catch (const std::exception& exception) {
    return Fail(ErrorCode::kCorrupt, std::string("corrupt: ") + exception.what());
  }
}

}  // namespace
}  // namespace pangaea

extern "C" __attribute__((visibility("default"))) const pangaea::ImageDecoder pangaea_image_decoder;
const pangaea::ImageDecoder pangaea_image_decoder{.decode_gray = &pangaea::DecodeGray};
