#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

// How a landmark of the map is looked for among a keyframe's keypoints.
struct LandmarkSearchOptions {
  // Half the search window in pixels of the octave.
  double radius = 4.0;
  // The same for a landmark that was last seen more than `old_after` keyframes ago, or by another session: the drift
  // since then counts.
  double old_radius = 8.0;
  std::uint32_t old_after = 20;
  // Two landmarks at one keypoint are one when each lies so close, in pixels of the octave, to where the other was
  // seen. Where one of the two is old, `old_radius` counts instead.
  double fusion_gate = 2.5;
  // Of 256 bits. Unrelated patches differ in 128 +- 20 bits, views of one patch mostly in < 60.
  int max_distance = 60;
  // The best match must differ in fewer bits than this part of the second best's.
  double max_ratio = 0.85;
  // Degrees between the ray of the nearest earlier view and the new ray: beyond it a patch looks too different.
  double max_view_angle = 60.0;
  // The keypoint's octave may differ by so much from the one that the distance predicts.
  int octave_tolerance = 1;
  // Each keypoint shows at most one of the landmarks: the one that looks most like it. Otherwise all that look like it,
  // which are then one.
  bool one_per_keypoint = true;
};

// A landmark that seems to be seen at a keypoint.
struct LandmarkSighting {
  LandmarkId landmark;
  std::uint32_t keypoint = 0;
  bool old = false;  // not seen for long before, see LandmarkSearchOptions
};

// Looks for the landmarks (`wanted`, each once) among the keypoints of `keyframe`, by projection and descriptor. Each
// landmark occurs once, and as the options say each keypoint. Landmarks that are gone, or that the keyframe observes
// already, are passed over.
std::vector<LandmarkSighting> FindLandmarks(const Atlas& atlas, const Keyframe& keyframe,
                                            const std::vector<LandmarkId>& wanted,
                                            const LandmarkSearchOptions& options);

// Whether some keyframe sees the two at pixels further apart than one corner can be.
bool SeenApart(const Atlas& atlas, const Landmark& a, const Landmark& b);

// Looks for the landmarks (`wanted`, each once) among the keypoints of `keyframe` and says what follows: a keypoint
// without a landmark is a new observation; one that shows another landmark makes the two one, if they agree
// geometrically. Landmarks that the keyframe observes already are passed over. Each landmark and each keypoint is
// touched by at most one edit.
std::vector<MapEdit> SearchLandmarks(const Atlas& atlas, const Keyframe& keyframe,
                                     const std::vector<LandmarkId>& wanted, const LandmarkSearchOptions& options);

// Fusion of two landmarks that one keypoint suggests; the one with more observations is kept, of equals the older.
// Nothing when they contradict each other: a keyframe sees them at different pixels, or one point lies further than
// `gate` octave pixels from where a keyframe saw the other one.
std::optional<MapEdit> FuseIfTheyAgree(const Atlas& atlas, const Landmark& a, const Landmark& b, double gate);

}  // namespace pangaea
