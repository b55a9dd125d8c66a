#pragma once

#include <cstddef>
#include <cstdint>

#include "common/base/result.h"
#include "common/lcm/channels.h"
#include "common/lcm/sender.h"
#include "common/sensor/dataset.h"

namespace pangaea {

// Sends a recording as a camera would: image_t or image_pair_t of each frame, and the calibration before the first one
// and once for each second of the recording. One thread.
class RecordingPublisher {
 public:
  struct Options {
    LcmChannels channels;
    // Image files as they are instead of their pixels: smaller messages, which the receiver decodes.
    bool send_files = false;
  };

  // `dataset` and `sender` outlive it. Left and right images go to two channels where `channels.right_images` says so.
  RecordingPublisher(const Dataset& dataset, LcmSender& sender, Options options);

  // A frame whose images cannot be read is skipped and counted, with `warning` about the first one; its number is left
  // out of the sequence on no channel. An error is one of the sender.
  Status Publish(const DatasetFrame& frame);
  std::size_t published() const { return published_; }
  std::size_t skipped() const { return skipped_; }
  const std::string& warning() const { return warning_; }

 private:
  Status PublishCalibration(std::int64_t stamp_ns);

  const Dataset& dataset_;
  LcmSender& sender_;
  const Options options_;
  std::int64_t calibration_due_ns_ = 0;
  std::size_t published_ = 0;
  std::size_t skipped_ = 0;
  std::string warning_;
};

}  // namespace pangaea
