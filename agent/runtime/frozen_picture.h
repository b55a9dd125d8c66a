#pragma once

#include <opencv2/core/mat.hpp>

namespace pangaea {

// Tells what a picture is worth that repeats the one before it bit by bit. Single ones are doubles of a frame, as
// videos brought to another rate have; one that goes on is a stuck camera, since noise makes any two pictures differ.
// Where pictures repeat from the first one on, as drawn ones of a camera that rests may, nothing is said. One owner
// thread.
class FrozenPicture {
 public:
  enum class Verdict {
    kNew,
    kDouble,  // says nothing that the one before has not said
    kStuck,   // where the camera was, not where it is
  };
  // Doubles in a row before the camera counts as stuck: 0.2 s at 20 Hz.
  static constexpr int kMostDoubles = 3;

  // Of 8 bit pictures. Keeps a reference to `image`.
  Verdict Judge(const cv::Mat& image);

 private:
  cv::Mat previous_;
  bool changes_ = false;
  int repeats_ = 0;
};

}  // namespace pangaea
