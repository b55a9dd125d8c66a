#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/features/matching.h"
#include "common/geometry/similarity3.h"
#include "server/place_recognition/place_recognition_options.h"
#include "server/place_recognition/place_view.h"

namespace pangaea {

// How far the comparison of two places came: each count is 0 where it was not reached.
struct AlignmentCounts {
  std::size_t own_matches = 0;  // landmarks of the two keyframes themselves that look alike
  std::size_t matches = 0;      // with those of the candidate's covisible keyframes
  std::size_t aligned = 0;      // of these, that fit the best motion of RANSAC
  std::size_t guided = 0;       // landmark pairs that fit after the first guided search
  std::size_t inliers = 0;      // and after the second
};

struct PlaceAlignment {
  Similarity3d candidate_from_query;
  std::vector<Match> pairs;    // landmark of the query's view, of the candidate's: those that fit
  std::size_t candidates = 0;  // pairs of the last guided search, of which `pairs` fit
  double rms_sigmas = 0.0;     // reprojection error of `pairs` in both images
};

// Whether the scale between the two is known to be 1: both cameras measure depth.
bool IsMetric(const PlaceView& query, const PlaceView& candidate);

// The motion under which many landmarks that look alike coincide, without a first guess: RANSAC on Horn's closed form
// (SE(3) where IsMetric, else Sim(3)), judged by the reprojection errors in both images. The same seed gives the same
// motion. `aligned` is how many fit it. Nothing where too few do.
std::optional<Similarity3d> FindMotion(const PlaceView& query, const PlaceView& candidate,
                                       std::span<const Match> matches, const PlaceGeometryOptions& options,
                                       std::uint64_t seed, std::size_t& aligned);

// Searches the landmarks of either side in the other's image, refines the motion, and does both again in smaller
// windows. Nothing where too few landmark pairs fit.
std::optional<PlaceAlignment> RefineAlignment(const PlaceView& query, const PlaceView& candidate,
                                              const Similarity3d& candidate_from_query,
                                              const PlaceGeometryOptions& options, AlignmentCounts& counts);

}  // namespace pangaea
