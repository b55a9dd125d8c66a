#include "common/sensor/frame_reader.h"

#include "common/sensor/image.h"

namespace pangaea {

Result<FrameReader> FrameReader::Create(const CameraRig& rig, SensorKind kind) {
  auto rectifier = Rectifier::Create(rig, kind);
  if (!rectifier) return tl::make_unexpected(rectifier.error());
  return FrameReader(std::move(*rectifier));
}

Result<cv::Mat> FrameReader::ReadLeft(const DatasetFrame& frame) const {
  const IdealCamera& camera = rectifier_.camera();
  return ReadGrayImage(frame.left, {camera.width, camera.height}).map([this](const cv::Mat& image) {
    return rectifier_.RectifyLeft(image);
  });
}

Result<cv::Mat> FrameReader::ReadRight(const DatasetFrame& frame) const {
  const IdealCamera& camera = rectifier_.camera();
  return ReadGrayImage(frame.right, {camera.width, camera.height}).map([this](const cv::Mat& image) {
    return rectifier_.RectifyRight(image);
  });
}

}  // namespace pangaea
