#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/estimation/absolute_pose.h"
#include "common/features/matching.h"
#include "common/map/atlas.h"

namespace pangaea {

struct RelocalizationOptions {
  std::size_t min_matches = 15;  // fewer are not worth an attempt at a pose
  double sigma = 1.2;            // pixels at octave 0: corners of two images, found independently
  MatchOptions matching;
  AbsolutePoseOptions pose;
};

struct Relocalized {
  KeyframeId keyframe;  // that the frame was recognised by
  Rigid3d camera_from_map;
  int inliers = 0;
};

// Poses of a frame from its features alone: descriptors against the landmarks of each candidate, then a three-point
// RANSAC. A candidate shows the landmarks of `window` keyframes, itself first and then those around it: from where
// nobody looked before each of them shows a few that look alike, together enough. One pose for each candidate that
// gives one, most inliers first, of equals the earlier candidate. The seed fixes the samples.
std::vector<Relocalized> Relocalize(const IdealCamera& camera, const Features& features, const Atlas& atlas,
                                    std::span<const KeyframeId> candidates, std::size_t window,
                                    const RelocalizationOptions& options, std::uint64_t seed);

}  // namespace pangaea
