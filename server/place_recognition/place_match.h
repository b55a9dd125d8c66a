#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "common/geometry/similarity3.h"
#include "common/map/ids.h"

namespace pangaea {

// What two maps have in common that were compared as wholes (CompareMaps).
struct ComparedMaps {
  std::size_t cells = 0;       // parts of space in which there are pairs
  double rms = 0.0;            // distance of the landmarks of a pair, map units
  double surface_share = 0.0;  // of the landmarks of one that lie on some landmark of the other
};

// Why a match is believed, for events and logs.
struct PlaceEvidence {
  double score = 0.0;        // of the candidate's bag of words, 0 to 1
  std::size_t matches = 0;   // landmark pairs after the guided search
  std::size_t inliers = 0;   // of these, after refinement
  std::size_t agreeing = 0;  // covisible keyframes of the query, itself included, that confirm the motion
  double rms_pixels = 0.0;   // reprojection error of the inliers in both images, in sigmas of their octaves
  // Not two keyframes were recognised, but two maps. Then `matches` are landmarks that look alike, `inliers` those that
  // lie on each other, and the figures between and after are 0.
  std::optional<ComparedMaps> compared = {};
};

// Two keyframes that show the same place, geometrically verified: in one map a loop, in two maps a merge.
struct PlaceMatch {
  KeyframeId query;      // the one looked up, mostly the newer one
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
