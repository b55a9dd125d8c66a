#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/estimation/pose_refinement.h"
#include "common/features/matching.h"
#include "common/map/atlas.h"
#include "common/mapping/observer_spread.h"

namespace pangaea {

struct GuidedSearchOptions {
  // Half the window around where the pose expects a landmark, pixels of the octave: first for a pose from a few
  // matches, then for one refined on what that found.
  double first_radius = 10.0;
  double radius = 4.0;
  // Degrees between the ray of the nearest earlier view and the new one: beyond it a patch looks too different.
  double max_view_angle = 60.0;
  int octave_tolerance = 1;
  double sigma = 1.2;  // pixels at octave 0: corners of two images, found independently
  MatchOptions matching{.max_distance = 64, .max_ratio = 0.85};
  PoseRefinementOptions refinement;
};

// A landmark that is alive in the atlas, and how well its place is known.
struct SoughtLandmark {
  LandmarkId id;
  ObserverSpread observers;
};

// A landmark seen at a keypoint of the frame.
struct GuidedMatch {
  std::uint32_t landmark = 0;  // index into what was sought
  std::uint32_t keypoint = 0;
  double sigma = 1.0;  // pixels, the landmark's own uncertainty included
};

struct GuidedLocation {
  RefinedPose pose;
  std::vector<GuidedMatch> matches;  // the inliers of the pose
  int searched = 0;                  // landmarks that should be in the image
  int found = 0;                     // ... and look like one of its keypoints, inliers or not
};

// Looks for landmarks among a frame's features, where a rough pose expects them, and refines the pose on them; twice,
// the second time where the first result expects them. The frame needs no depth. Nothing when there is no pose on
// options.refinement.min_inliers.
std::optional<GuidedLocation> LocateByDescriptors(const IdealCamera& camera, const Features& features,
                                                  const Atlas& atlas, const Rigid3d& rough_camera_from_map,
                                                  std::span<const SoughtLandmark> sought,
                                                  const GuidedSearchOptions& options);

// The median depth of the landmarks that were matched, map units.
double MedianDepth(const GuidedLocation& location, const Atlas& atlas, std::span<const SoughtLandmark> sought);

}  // namespace pangaea
