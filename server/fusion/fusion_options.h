#pragma once

#include <cstddef>

#include "common/base/result.h"
#include "common/mapping/landmark_search.h"
#include "common/mapping/measurement_noise.h"

namespace pangaea {

struct WeldingWindowOptions {
  // Keyframes on each side of the seam that are adjusted together (Elvira et al. 2019, section "Seamless map merging":
  // those covisible with the matched ones).
  std::size_t keyframes = 25;
  // Of those, so many nearest the seam on each side look for the landmarks of as many on the other side (count): the
  // search grows with their square, and what lies further off is found later, all along the map (FuseDuplicates).
  std::size_t searched = 10;
  // Keyframes around the older side that see its landmarks and are held fixed (count; those with most of them).
  std::size_t fixed_keyframes = 30;
};

// When a seam holds. A match passed geometric verification already; what is judged here is whether the two sides as a
// whole lie on each other.
struct SeamJudgementOptions {
  // Landmarks that both sides see after fusion (count). A pose needs about twenty; fewer do not hold two maps together.
  std::size_t min_common_landmarks = 20;
  // Part of the observations of these that agree with the welded map.
  double min_inlier_share = 0.7;
  // The mean robust cost of an observation in the window may grow by this factor: two maps that were adjusted apart
  // bend a little to fit each other.
  double max_cost_growth = 1.3;
  // Below this mean cost (half a squared sigma a component) nothing is bent, however it grew: noise alone costs 1 to
  // 1.5, and maps that are young, with few observations of each landmark, fit better than they are.
  double noise_cost = 0.6;
};

// What a loop may contradict: the way through the map that leads from one end to the other, over edges that were
// verified before, allows only so much drift.
struct DriftOptions {
  double translation_per_path = 0.05;  // length of the difference by length of the way
  double rotation_per_path = 1.0;      // degrees for each scene depth of the way
  double scale_per_path = 0.01;        // of a scale-free map: change of log scale for each scene depth of the way
  // What is allowed however short the way.
  double min_translation = 0.1;  // scene depths (median distance of the landmarks at the match)
  double min_rotation = 4.0;     // degrees
  double min_scale = 0.1;        // log scale
  // Covisible keyframes that share fewer landmarks than this are no edge of a way (count).
  unsigned min_shared_landmarks = 15;
};

struct FusionOptions {
  MeasurementNoiseOptions noise;
  WeldingWindowOptions window;
  // Half the search window, and how far a landmark may lie from where the other was seen, in pixels of the octave:
  // before the bundle adjustment, when both sides still have their own errors, and after it.
  double first_radius = 8.0;
  double second_radius = 4.0;
  LandmarkSearchOptions search;         // its radii and gate are replaced by those
  int iterations = 6;                   // steps of the bundle adjustment with all observations
  int iterations_without_outliers = 4;  // then so many without the outliers these showed, with a narrower kernel
  // Each ends earlier when a step lowers the cost by less than this, relatively: the whole map is adjusted soon.
  double cost_tolerance = 1e-3;
  SeamJudgementOptions judgement;
  DriftOptions drift;

  // Says which option is out of which range.
  Status Check() const;
};

}  // namespace pangaea
