#pragma once

#include <cstddef>
#include <vector>

#include "common/features/matching.h"
#include "common/geometry/similarity3.h"
#include "server/place_recognition/place_recognition_options.h"
#include "server/place_recognition/place_view.h"

namespace pangaea {

// Where the landmarks of a place were looked for in one image, and which keypoint looks like each.
struct GuidedSearch {
  std::vector<Match> matches;  // landmark of the place, keypoint of the image
  std::size_t visible = 0;     // landmarks that should be in the image
  // Parts of the image (of a grid) in which several landmarks should be, and those of them in which some are found.
  std::size_t expected_cells = 0;
  std::size_t confirmed_cells = 0;
};

// Looks for the landmarks of `place` in the image of another keyframe. `camera_from_center`: from the camera frame of
// the place's central keyframe to that of the other one. `grid`: of the other's keypoints. `radius`: octave pixels.
GuidedSearch SearchInImage(const PlaceView& place, const KeyframeData& image, const FeatureGrid& grid,
                           const Similarity3d& camera_from_center, double radius, const PlaceGeometryOptions& options);

// Landmarks of the query's view and of the candidate's view that look alike and lie within `radius` octave pixels of
// each other in the query's or the candidate's image. Each landmark occurs once; ascending by the query's.
std::vector<Match> SearchLandmarkPairs(const PlaceView& query, const PlaceView& candidate,
                                       const Similarity3d& candidate_from_query, double radius,
                                       const PlaceGeometryOptions& options);

}  // namespace pangaea
