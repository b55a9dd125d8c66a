#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/base/result.h"
#include "common/mapping/landmark_creation_options.h"
#include "common/mapping/landmark_search.h"
#include "common/mapping/landmark_visits.h"
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

// kFast: our own solver, dense for windows of up to kDenseKeyframes, sparse for larger ones.
enum class BundleAdjustmentBackEnd { kFast, kCeres };
inline constexpr std::size_t kDenseKeyframes = 60;

struct LocalBundleAdjustmentOptions {
  // Keyframes whose poses are free: the new one, its best covisible ones, then theirs (count).
  std::size_t window_keyframes = 20;
  // Keyframes held fixed because they see the window's landmarks; the ones with most such landmarks (count).
  std::size_t fixed_keyframes = 30;
  int iterations = 5;                   // steps with all observations
  int iterations_without_outliers = 3;  // then so many without the outliers these showed, with a narrower kernel
  double cost_tolerance = 1e-6;         // either ends when a step lowers the cost by less than this share of it
  // None: what sees the same landmark holds together as it is, as where a server adjusts the map as a whole.
  std::optional<VisitOptions> visits = VisitOptions();
  // Where visits may have drifted apart (common/mapping/landmark_visits.h): so many steps first pull together what sees
  // the same landmarks. 0: none.
  int iterations_together = 0;
  BundleAdjustmentBackEnd back_end = BundleAdjustmentBackEnd::kFast;
};

// The adjustment of the whole way by which the camera came back to an old place
// (docs/decisions/0022-coming-back-alone.md).
struct WideAdjustmentOptions {
  bool enabled = true;  // where nobody else closes loops
  // It follows when more than this share of the observations of the local window's landmarks contradict the map. Before
  // a camera first came back it was less than a thousandth in two rendered flights: adjustments remove what contradicts
  // them.
  double max_strain = 0.01;
  // Where more than this share of all observations contradict the result (in eleven flights it was 0.0014 at most), the
  // old place was a wrong one, and the map stays as it was.
  double max_outliers = 0.01;
  std::size_t strain_samples = 400;  // of the window's landmarks (count)
  // Keyframes made since the one before, at least: a count, and as a share of all until then. So its cost, which grows
  // with the map, stays a bounded part of mapping's.
  std::uint32_t min_gap = 20;
  double min_growth = 0.25;
  // So many keyframes are a way of several minutes. Few steps: the drift is small, and local adjustments take the rest.
  LocalBundleAdjustmentOptions bundle_adjustment{.window_keyframes = 500,
                                                 .fixed_keyframes = 100,
                                                 .iterations = 5,
                                                 .iterations_without_outliers = 3,
                                                 .cost_tolerance = 1e-2,
                                                 .visits = VisitOptions(),
                                                 .iterations_together = 5};
};

// Whether the right camera looks where the calibration says (docs/decisions/0024-vergence.md).
struct VergenceOptions {
  // Looked at when the session has so many keyframes, and whenever it has twice as many as last time (count).
  std::uint32_t first_keyframes = 10;
  // What was found better is believed when a look so many keyframes later (count), or half as many where the map is
  // closed, finds a change to the same side.
  std::uint32_t second_look_keyframes = 10;
  std::size_t window_keyframes = 20;  // around the newest (count)
  // A correction is made of shifts in the image's middle of at least so many pixels: exactly calibrated flights show up
  // to 0.05, from matching. 100: never.
  double min_shift = 0.1;
  double min_sigmas = 3.0;  // … and standard deviations
  // … where keyframes elsewhere say the same: a window may mislead (docs/decisions/0024-vergence.md). While there are
  // less than first_keyframes elsewhere, of so many pixels.
  double min_lone_shift = 0.3;
  // What is found at least so many pixels off is believed at once: exact rigs have shown 0.42 at most, once.
  double min_sure_shift = 0.8;
  int iterations = 15;  // of each adjustment; most end earlier
  double cost_tolerance = 1e-5;
};

struct KeyframeCullingOptions {
  // Part of a keyframe's landmarks that enough others see as well: then it says nothing new.
  double redundant_ratio = 0.9;
  std::size_t other_observers = 5;  // count; with 3 the adjusted poses get 1.5 times worse, as tracks get shorter
  // The newest keyframes are never culled: tracking refers to them and their landmarks are on trial (count).
  std::uint32_t newest_kept = 3;
};

struct LocalMappingOptions {
  // Keypoints of rendered flights lie 0.5 to 0.6 octave pixels (RMS) from their landmarks. At one pixel, another corner
  // 2 pixels away passes as noise (docs/decisions/0025-noise-of-a-map.md).
  MeasurementNoiseOptions noise = {.pixel_sigma = 0.6};
  NeighbourhoodOptions neighbourhood;
  LandmarkSearchOptions search;
  std::size_t fused_keyframes = 20;  // covisible keyframes in which the new keyframe's landmarks are looked for (count)
  LandmarkCreationOptions creation;
  LandmarkCullingOptions landmark_culling;
  LocalBundleAdjustmentOptions bundle_adjustment;
  WideAdjustmentOptions wide_adjustment;
  VergenceOptions vergence;
  KeyframeCullingOptions keyframe_culling;

  // Says which option is out of which range.
  Status Check() const;
};

}  // namespace pangaea
