#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/estimation/absolute_pose.h"
#include "common/features/matching.h"
#include "common/map/atlas.h"

namespace pangaea {

struct RelocalizationOptions {
  std::size_t max_candidates = 12;  // keyframes compared with the frame, descriptor by descriptor
  std::size_t min_matches = 15;     // fewer are not worth an attempt at a pose
  double sigma = 1.2;               // pixels at octave 0: corners of two images, found independently
  MatchOptions matching;
  AbsolutePoseOptions pose;
};

struct Relocalized {
  KeyframeId keyframe;  // that the frame was recognised by
  Rigid3d camera_from_map;
  int inliers = 0;
};

// Finds the pose of a frame from its features alone: descriptors against each candidate keyframe's landmarks, then a
// perspective-n-point RANSAC. Returns the candidate with most inliers. The seed fixes the samples.
std::optional<Relocalized> Relocalize(const IdealCamera& camera, const Features& features, const Atlas& atlas,
                                      std::span<const KeyframeId> candidates, const RelocalizationOptions& options,
                                      std::uint64_t seed);

}  // namespace pangaea
