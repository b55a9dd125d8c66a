#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "agent/tracking/local_map.h"
#include "agent/tracking/patch_search.h"
#include "common/features/matching.h"

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

// A frame located by its corners and descriptors.
struct GuidedFrame {
  LocatedFrame located;
  std::vector<std::uint32_t> keypoints;  // of the frame, one for each of located.matches
};

// Looks for the local map's landmarks among a frame's features, where a rough pose expects them, and refines the pose
// on them. Needs no templates: this is how a place is entered whose images are long gone. `local_map` was collected
// from `atlas`. Nothing when there is no pose on options.refinement.min_inliers.
std::optional<GuidedFrame> LocateByDescriptors(const IdealCamera& camera, const Features& features, const Atlas& atlas,
                                               const Rigid3d& rough_camera_from_map, const LocalMap& local_map,
                                               const GuidedSearchOptions& options);

}  // namespace pangaea
