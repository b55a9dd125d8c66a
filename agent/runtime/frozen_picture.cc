#include "agent/runtime/frozen_picture.h"

#include <cstring>

namespace pangaea {
namespace {

bool AreEqual(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  const std::size_t bytes = static_cast<std::size_t>(a.cols) * a.elemSize();
  for (int y = 0; y < a.rows; ++y) {
    if (std::memcmp(a.ptr(y), b.ptr(y), bytes) != 0) return false;
  }
  return true;
}

}  // namespace

bool FrozenPicture::Repeats(const cv::Mat& image) {
  if (!previous_.empty() && AreEqual(image, previous_)) return changes_;
  changes_ = !previous_.empty();
  previous_ = image;
  return false;
}

}  // namespace pangaea
