#pragma once

#include <cstddef>

#include "common/base/result.h"

namespace pangaea {

// How a landmark of the map is looked for among a keyframe's keypoints.
struct LandmarkSearchOptions {
  // Half the search window at octave 0, pixels; it grows with the octave's scale. Wide enough for the drift since the
  // place was last seen, narrow enough that the descriptor need not decide alone.
  double radius = 4.0;
  // Of 256 bits. Unrelated patches differ in 128 +- 8 bits (less on repetitive texture), views of one patch in < 50.
  int max_distance = 60;
  // The best match must beat the second best of the same octave by this factor of distances.
  double max_ratio = 0.85;
  // Degrees between the ray of the nearest earlier view and the new ray: beyond it a patch looks too different.
  double max_view_angle = 60.0;
  // The keypoint's octave may differ by so much from the one that the distance predicts.
  int octave_tolerance = 1;
  // Neighbours of the keyframe, and neighbours of those, whose landmarks are looked for (counts).
  std::size_t first_neighbours = 15;
  std::size_t second_neighbours = 5;
};

struct LandmarkCreationOptions {
  // Stereo depth below this many baselines is good enough for a landmark by itself: at 40 baselines and 0.5 px of
  // disparity noise a 450 px camera errs by 4 % of the depth.
  double close_depth_baselines = 40.0;
  // A new map takes stereo depth up to this many baselines: without distant landmarks rotation is poorly observed.
  double first_depth_baselines = 120.0;
  // Keyframes that new landmarks are triangulated with (count).
  std::size_t neighbours = 8;
  // Degrees between the two rays: below it depth is noise.
  double min_parallax = 0.8;
  // Shortest distance between the two cameras as a part of the median depth of the scene.
  double min_relative_baseline = 0.01;
  int max_distance = 50;      // Hamming, of 256 bits
  double max_ratio = 0.8;     // best to second best distance along the epipolar line
  double max_epipolar = 2.0;  // standard deviations of the keypoint's distance from the epipolar line
};

struct LandmarkCullingOptions {
  // Keyframes after its creation at which a landmark stands the test; then it is trusted.
  std::size_t trial_keyframes = 3;
  // Observers that a landmark needs from the second keyframe after its creation on: the creating keyframe and one
  // more with stereo depth; a monocular landmark is born with two and needs a third.
  std::size_t min_observers_stereo = 2;
  std::size_t min_observers_monocular = 3;
  // Part of the keyframes that should have seen it (by projection) which did; below it, it goes.
  double min_found_ratio = 0.25;
};

enum class BundleAdjustmentBackEnd { kFast, kCeres };

struct LocalBundleAdjustmentOptions {
  // Keyframes whose poses are free: the new one and its best covisible ones (count).
  std::size_t window_keyframes = 12;
  // Keyframes held fixed because they see the window's landmarks; the ones with most such landmarks (count).
  std::size_t fixed_keyframes = 30;
  int max_iterations = 8;
  BundleAdjustmentBackEnd back_end = BundleAdjustmentBackEnd::kFast;
};

struct KeyframeCullingOptions {
  // Part of a keyframe's landmarks that enough others see as well: then it says nothing new.
  double redundant_ratio = 0.9;
  std::size_t other_observers = 3;  // count
  // The newest keyframes are never culled: tracking refers to them and their landmarks are on trial (count).
  std::size_t newest_kept = 3;
};

// Standard deviations of observations, pixels; see measurement_noise.h.
struct MeasurementNoiseOptions {
  double pixel_sigma = 0.7;  // of u and v at octave 0
  double right_sigma = 0.7;  // of u_right at octave 0
};

struct LocalMappingOptions {
  MeasurementNoiseOptions noise;
  LandmarkSearchOptions search;
  LandmarkCreationOptions creation;
  LandmarkCullingOptions landmark_culling;
  LocalBundleAdjustmentOptions bundle_adjustment;
  KeyframeCullingOptions keyframe_culling;

  // Says which option is out of which range.
  Status Check() const;
};

}  // namespace pangaea
