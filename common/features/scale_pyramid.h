#pragma once

#include <array>
#include <opencv2/core/mat.hpp>

#include "common/geometry/keypoint.h"

namespace pangaea {

// An image reduced by kOctaveScale from octave to octave. Every octave has a mirrored margin of kMargin pixels around
// it, so that a patch around any of its pixels can be read, and all octaves have one row stride, so that one table of
// memory offsets serves them all. Buffers are reused; one pyramid belongs to one thread.
class ScalePyramid {
 public:
  static constexpr int kMargin = 24;

  // `image` is CV_8UC1. The octaves are copies: the image may change afterwards.
  void Build(const cv::Mat& image);

  // A view without the margin; the pixels of the margin lie around it in memory.
  const cv::Mat& octave(int octave) const { return octaves_[static_cast<std::size_t>(octave)]; }
  const cv::Mat& padded(int octave) const { return padded_[static_cast<std::size_t>(octave)]; }  // with the margin
  int stride() const { return stride_; }  // bytes from row to row, of every octave
  // Full-resolution pixel to the octave's pixel and back. Pixel areas correspond, so centres shift a little.
  cv::Point2f ToOctave(cv::Point2f pixel, int octave) const {
    const cv::Point2f ratio = ratios_[static_cast<std::size_t>(octave)];
    return {(pixel.x + 0.5F) / ratio.x - 0.5F, (pixel.y + 0.5F) / ratio.y - 0.5F};
  }
  cv::Point2f FromOctave(cv::Point2f pixel, int octave) const {
    const cv::Point2f ratio = ratios_[static_cast<std::size_t>(octave)];
    return {(pixel.x + 0.5F) * ratio.x - 0.5F, (pixel.y + 0.5F) * ratio.y - 0.5F};
  }

 private:
  std::array<cv::Mat, kOctaves> buffers_;
  std::array<cv::Mat, kOctaves> padded_;      // views into buffers_
  std::array<cv::Mat, kOctaves> octaves_;     // views into buffers_
  std::array<cv::Point2f, kOctaves> ratios_;  // full-resolution pixels per pixel of the octave, along u and v
  int stride_ = 0;
};

}  // namespace pangaea
