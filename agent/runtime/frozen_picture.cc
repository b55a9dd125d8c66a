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

FrozenPicture::Verdict FrozenPicture::Judge(const cv::Mat& image) {
  if (!previous_.empty() && AreEqual(image, previous_)) {
    if (!changes_) return Verdict::kNew;
    return ++repeats_ <= kMostDoubles ? Verdict::kDouble : Verdict::kStuck;
  }
  changes_ = !previous_.empty();
  repeats_ = 0;
  previous_ = image;
  return Verdict::kNew;
}

}  // namespace pangaea
