#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "server/place_recognition/place_agreement.h"
#include "server/place_recognition/place_alignment.h"
#include "server/place_recognition/place_match.h"

namespace pangaea {

// How recognition ended: recognised, or the farthest step at which the last candidate fell out.
enum class PlaceOutcome {
  kUnknownKeyframe,  // the query is not in the snapshot
  kFewLandmarks,     // it sees too few to compare anything
  kNoCandidate,      // nothing in the index looks like it
  kFewMatches,       // too few landmarks look alike
  kNoMotion,         // they do not fit one motion
  kFewInliers,       // with the motion, too few more are found
  kContradicted,     // keyframes around the query should see the place and do not
  kFewAgreeing,      // too few keyframes around it confirm the motion; perhaps later ones do
  kRecognized,
};
// For logs and counters: "few_matches".
std::string_view ToString(PlaceOutcome outcome);

// One candidate that was compared with the query.
struct PlaceTrial {
  KeyframeId candidate;
  double score = 0.0;  // of the bag of words; 0 where an earlier keyframe's motion was tried
  PlaceOutcome outcome = PlaceOutcome::kFewMatches;
  AlignmentCounts counts;
  std::optional<Similarity3d> candidate_from_query{};  // where the geometry was verified
  std::size_t agreeing = 0;                            // keyframes, the query included
  std::size_t contradicting = 0;
  std::vector<PlaceWitness> witnesses;  // the covisible keyframes that were asked
};

struct PlaceReport {
  PlaceOutcome outcome = PlaceOutcome::kUnknownKeyframe;
  std::size_t postings_read = 0;  // what the query of the index cost
  std::size_t candidates = 0;     // keyframes that looked alike
  std::vector<PlaceTrial> trials;
};

struct PlaceRecognition {
  std::vector<PlaceMatch> matches;  // the best first; at most one for each map
  PlaceReport report;
};

}  // namespace pangaea
