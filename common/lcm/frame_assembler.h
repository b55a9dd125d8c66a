#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/lcm/channels.h"
#include "common/lcm/receiver.h"
#include "common/sensor/frame_stream.h"
#include "common/sensor/image.h"
#include "common/sensor/sensor_kind.h"

namespace pangaea {

// Makes frames of image messages: takes pairs apart, puts left and right images of one instant together, and counts
// what the network lost. Messages may hold anything. One thread.
class FrameAssembler {
 public:
  FrameAssembler(SensorKind kind, LcmChannels channels, ImageSize size);

  // A frame as soon as it is whole; nothing while its other half is awaited; an error for what is no image. The images
  // are decoded later, by the loaders of the frame.
  std::optional<Result<StreamFrame>> Add(const LcmMessage& message);
  // Images that were sent and never arrived, as their numbers tell, and halves that never found the other one.
  std::size_t missing() const { return missing_; }

 private:
  // An image whose other half has not come yet.
  struct Half {
    std::int64_t stamp_ns = 0;
    ImageLoader image;
  };

  void Count(const std::string& channel, std::int64_t sequence);
  std::optional<Result<StreamFrame>> AddHalf(Half half, bool is_left);

  const SensorKind kind_;
  const LcmChannels channels_;
  const ImageSize size_;
  std::map<std::string, std::int64_t> latest_sequence_;  // of each channel
  std::deque<Half> left_;                                // oldest first
  std::deque<Half> right_;
  std::size_t missing_ = 0;
};

}  // namespace pangaea
