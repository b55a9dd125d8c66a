#pragma once

#include <opencv2/core/mat.hpp>

#include "common/base/result.h"
#include "common/sensor/dataset.h"
#include "common/sensor/rectifier.h"

namespace pangaea {

// Reads images of a dataset and rectifies them. Left and right apart, because tracking needs the right one only where
// it wants depth. Any thread.
class FrameReader {
 public:
  static Result<FrameReader> Create(const CameraRig& rig, SensorKind kind);

  const Rectifier& rectifier() const { return rectifier_; }
  // The ideal camera's 8-bit image, or why the file gives none (the caller skips the frame and counts it).
  Result<cv::Mat> ReadLeft(const DatasetFrame& frame) const;
  Result<cv::Mat> ReadRight(const DatasetFrame& frame) const;

 private:
  explicit FrameReader(Rectifier rectifier) : rectifier_(std::move(rectifier)) {}

  Rectifier rectifier_;
};

}  // namespace pangaea
