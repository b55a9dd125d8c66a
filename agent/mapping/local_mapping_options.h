#pragma once

#include <cstddef>
#include <cstdint>

#include "common/base/result.h"
#include "common/mapping/landmark_creation_options.h"
#include "common/mapping/landmark_search.h"
#include "common/mapping/measurement_noise.h"

namespace pangaea {

// Which keyframes count as near to a new one.
struct NeighbourhoodOptions {
  std::size_t first = 15;          // best covisible keyframes (count)
  std::size_t second_of_each = 5;  // and of each of those its best ones (count)
  // Keyframes that look at the same place without sharing a landmark yet (count): that is how an old place is found
  // again as long as the drift is less than the search window.
  std::size_t overlapping = 6;
  double max_axis_angle = 50.0;      // degrees between the optical axes of such a keyframe and the new one
  double min_overlap = 0.3;          // part of its landmarks that project into the new one
  std::size_t overlap_samples = 40;  // landmarks tried for that (count)
};

struct LandmarkCullingOptions {
  // A landmark is judged by the later keyframes that should have seen it (chances, by projection). The first verdict
  // comes after so many chances, the last after so many; a landmark with few chances is judged at the latest when so
  // many keyframes have been mapped since its creation.
  std::uint32_t first_verdict_chances = 2;
  std::uint32_t trial_chances = 3;
  std::uint32_t max_keyframes = 10;
  // Observers that a landmark needs: the creating keyframe and one more with stereo depth; a monocular landmark is
  // born with two and needs a third.
  std::size_t min_observers_stereo = 2;
  std::size_t min_observers_monocular = 3;
  // Part of the chances that were taken; below it, the landmark goes.
  double min_found_ratio = 0.25;
};

enum class BundleAdjustmentBackEnd { kFast, kCeres };

struct LocalBundleAdjustmentOptions {
  // Keyframes whose poses are free: the new one, its best covisible ones, then theirs (count).
  std::size_t window_keyframes = 20;
  // Keyframes held fixed because they see the window's landmarks; the ones with most such landmarks (count).
  std::size_t fixed_keyframes = 30;
  int iterations = 5;                   // steps with the robust kernel
  int iterations_without_outliers = 3;  // then so many without it and without the outliers it showed
  BundleAdjustmentBackEnd back_end = BundleAdjustmentBackEnd::kFast;
};

struct KeyframeCullingOptions {
  // Part of a keyframe's landmarks that enough others see as well: then it says nothing new.
  double redundant_ratio = 0.9;
  std::size_t other_observers = 5;  // count; with 3 the adjusted poses get 1.5 times worse, as tracks get shorter
  // The newest keyframes are never culled: tracking refers to them and their landmarks are on trial (count).
  std::uint32_t newest_kept = 3;
};

struct LocalMappingOptions {
  MeasurementNoiseOptions noise;
  NeighbourhoodOptions neighbourhood;
  LandmarkSearchOptions search;
  std::size_t fused_keyframes = 20;  // covisible keyframes in which the new keyframe's landmarks are looked for (count)
  LandmarkCreationOptions creation;
  LandmarkCullingOptions landmark_culling;
  LocalBundleAdjustmentOptions bundle_adjustment;
  KeyframeCullingOptions keyframe_culling;

  // Says which option is out of which range.
  Status Check() const;
};

}  // namespace pangaea
