#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "common/geometry/similarity3.h"
#include "common/map/ids.h"

namespace pangaea {

// Why a match is believed, for events and logs.
struct PlaceEvidence {
  double score = 0.0;        // of the candidate's bag of words, 0 to 1
  std::size_t matches = 0;   // landmark pairs after the guided search
  std::size_t inliers = 0;   // of these, after refinement
  std::size_t agreeing = 0;  // covisible keyframes of the query, itself included, that confirm the motion
  double rms_pixels = 0.0;   // reprojection error of the inliers in both images, in sigmas of their octaves
};

// Two keyframes that show the same place, geometrically verified: in one map a loop, in two maps a merge.
struct PlaceMatch {
  KeyframeId query;      // the newer one
  KeyframeId candidate;  // the one recognised
  // Camera frame of `query` (lengths of its map) to camera frame of `candidate` (lengths of its map). Where both maps
  // are metric, the scale is exactly 1.
  Similarity3d candidate_from_query;
  bool metric = true;
  // Landmarks of the query's side and of the candidate's side that are the same point; each occurs once.
  std::vector<std::pair<LandmarkId, LandmarkId>> landmarks;
  PlaceEvidence evidence;
};

}  // namespace pangaea
