#pragma once

#include <cstddef>

namespace pangaea {

// Which points a keyframe makes landmarks of.
struct LandmarkCreationOptions {
  // Stereo depth below this many baselines is good enough for a landmark by itself: at 40 baselines and 0.5 px of
  // disparity noise a camera with a focal length of 450 px errs by 4 % of the depth.
  double close_depth_baselines = 40.0;
  // A new map takes stereo depth up to this many baselines: without distant landmarks rotation is poorly observed.
  double first_depth_baselines = 120.0;
  // Where fewer close landmarks than this are in view, the next nearest stereo points are taken too (count).
  std::size_t min_close_landmarks = 100;
  // Keyframes that new landmarks are triangulated with (count).
  std::size_t neighbours = 8;
  // Degrees between the two rays: below it depth is noise.
  double min_parallax = 0.8;
  int max_distance = 50;      // Hamming, of 256 bits: the epipolar line predicts less than a projection does
  double max_ratio = 0.8;     // best to second best distance along the epipolar line
  double max_epipolar = 2.0;  // distance from the epipolar line, in standard deviations of a keypoint
  // The octaves at which the two views found the corner must fit its two distances to this factor.
  double max_scale_error = 1.8;
};

}  // namespace pangaea
