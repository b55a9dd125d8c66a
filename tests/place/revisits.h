#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "common/geometry/ideal_camera.h"
#include "common/geometry/keypoint.h"
#include "common/geometry/rigid3.h"
#include "common/place/inverted_index.h"
#include "common/place/vocabulary_tree.h"

namespace pangaea::testing {

// A stereo keyframe of a recording with ground truth.
struct SurveyedKeyframe {
  Features features;  // with u_right where stereo matching found it
  IdealCamera camera;
  Rigid3d world_from_camera;
  Rigid3d world_from_body;
};

// The share of a's stereo points that b sees, too: within 10 pixels of where the truth puts the point there is a stereo
// point of b at the same depth (5 % and 5 cm). What stands before the point or lies outside of the image does not
// count. Of unrelated views it is below 0.1.
double SharedView(const SurveyedKeyframe& a, const SurveyedKeyframe& b);

// Which keyframes must be found, and which answers are right. Candidates are the keyframes more than `least_gap`
// earlier.
struct RevisitLimits {
  std::size_t least_gap = 10;
  // A revisit's body is nearer to that of a candidate than both:
  double distance = 1.0;  // metres
  double angle = 30.0;    // degrees
  // An answer is right where it shares so much of the view.
  double shared_view = 0.2;
};

// The answer to one keyframe looked up among the earlier ones.
struct Lookup {
  std::size_t keyframe = 0;
  bool is_revisit = false;
  std::optional<std::size_t> candidate;  // the first of the ranking
  bool candidate_is_right = false;
  double score = 0.0;  // of the candidate
};

std::vector<Lookup> LookUpAll(const std::vector<SurveyedKeyframe>& keyframes, const VocabularyTree& vocabulary,
                              const RevisitLimits& limits);

struct PrecisionRecall {
  double threshold = 0.0;  // candidates of at least this score are accepted
  double precision = 1.0;  // accepted candidates that are right
  double recall = 0.0;     // revisits with an accepted, right candidate
};

// One point for every score that occurs, from the highest down.
std::vector<PrecisionRecall> PrecisionRecallCurve(std::vector<Lookup> lookups);

// The largest recall at which every accepted candidate is right.
double RecallAtFullPrecision(const std::vector<PrecisionRecall>& curve);

}  // namespace pangaea::testing
