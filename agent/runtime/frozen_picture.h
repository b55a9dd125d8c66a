#pragma once

#include <opencv2/core/mat.hpp>

namespace pangaea {

// Tells that a camera is stuck: noise makes any two pictures of a real one differ. Where pictures repeat from the first
// one on, as drawn ones of a camera that rests may, nothing is said. One owner thread.
class FrozenPicture {
 public:
  // Whether `image` (8 bits) is bit by bit the picture before, after pictures that differed. Keeps a reference to it.
  bool Repeats(const cv::Mat& image);

 private:
  cv::Mat previous_;
  bool changes_ = false;
};

}  // namespace pangaea
