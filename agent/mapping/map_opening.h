#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "agent/mapping/keyframe_candidate.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

// A point that both keyframes of an opening see.
struct OpeningPoint {
  std::uint32_t first_keypoint = 0;
  std::uint32_t second_keypoint = 0;
  Eigen::Vector3d point_in_first;  // camera frame of the first keyframe
};

// How a monocular map begins: with two keyframes, whose motion gives the map its points and its scale.
struct MapOpening {
  KeyframeCandidate first;   // the root, without landmarks
  KeyframeCandidate second;  // its reference is the first
  std::vector<OpeningPoint> points;
};

// The edits that make a map of it; the points become landmarks with ids from `first_id` on. None where the map or one
// of the keyframes exists already.
std::vector<MapEdit> OpenMap(const Atlas& atlas, const MapOpening& opening, LandmarkId first_id);

}  // namespace pangaea
