#include "common/lcm/recording_publisher.h"

#include <utility>
#include <vector>

#include "common/lcm/calibration_codec.h"
#include "common/lcm/image_codec.h"
#include "common/sensor/image.h"

namespace pangaea {
namespace {

using pangaea_lcm::image_t;

constexpr std::int64_t kCalibrationInterval_ns = 1'000'000'000;

Result<image_t> FileMessage(const std::filesystem::path& path, ImageSize size) {
  const auto octets = ReadImageFile(path);
  if (!octets) return tl::make_unexpected(octets.error());
  image_t message{};
  message.width = size.width;
  message.height = size.height;
  message.pixel_format = image_t::IMAGE_FILE;
  message.size = static_cast<std::int32_t>(octets->size());
  message.data.reserve(octets->size());
  for (const std::byte octet : *octets) message.data.push_back(std::to_integer<std::uint8_t>(octet));
  return message;
}

}  // namespace

RecordingPublisher::RecordingPublisher(const Dataset& dataset, LcmSender& sender, Options options)
    : dataset_(dataset), sender_(sender), options_(std::move(options)) {}

Status RecordingPublisher::Publish(const DatasetFrame& frame) {
  if (published_ == 0 || frame.stamp_ns >= calibration_due_ns_) {
    if (auto status = PublishCalibration(frame.stamp_ns); !status) return status;
  }
  const ImageSize size{dataset_.rig.left.width, dataset_.rig.left.height};
  std::vector<image_t> images;
  for (const std::string& path : {frame.left, frame.right}) {
    if (path.empty()) continue;
    auto message = options_.send_files
                       ? FileMessage(path, size)
                       : ReadGrayImage(path, size).map([](const cv::Mat& gray) { return ImageMessage(gray, 0, 0); });
    if (!message) {
      if (skipped_++ == 0) warning_ = message.error().message;
      return {};
    }
    message->stamp_ns = frame.stamp_ns;
    message->sequence = static_cast<std::int64_t>(published_);
    images.push_back(std::move(*message));
  }
  ++published_;
  const LcmChannels& channels = options_.channels;
  if (images.size() == 1 || channels.right_images.empty()) {
    return sender_.Send(channels.images, EncodeImages(images), frame.stamp_ns);
  }
  if (auto status = sender_.Send(channels.images, EncodeImages({images[0]}), frame.stamp_ns); !status) return status;
  return sender_.Send(channels.right_images, EncodeImages({images[1]}), frame.stamp_ns);
}

Status RecordingPublisher::PublishCalibration(std::int64_t stamp_ns) {
  calibration_due_ns_ = stamp_ns + kCalibrationInterval_ns;
  return sender_.Send(options_.channels.calibration, EncodeCalibration(dataset_.rig), stamp_ns);
}

}  // namespace pangaea
