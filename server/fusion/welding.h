#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <stop_token>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "server/fusion/drift_check.h"
#include "server/fusion/fusion_options.h"
#include "server/fusion/seam_residual.h"
#include "server/optimization/correction.h"
#include "server/place_recognition/place_match.h"

namespace pangaea {

// What speaks for a weld or against it, as far as it got.
struct WeldingEvidence {
  PlaceEvidence match;
  std::size_t window_keyframes = 0;  // of both sides together
  std::size_t common_landmarks = 0;  // seen from both sides after fusion
  std::size_t fused = 0;             // duplicates that became one
  std::size_t added = 0;             // observations of one side's landmarks in the other's keyframes
  std::size_t removed = 0;           // observations that contradicted
  SeamResidual before;               // of the two sides, each by itself
  SeamResidual after;                // of the welded window, with all that joins the sides
  SeamResidual common;               // of that, the landmarks which both sides see
  double scale = 1.0;                // lengths of the moved side are multiplied by this
  LoopDrift drift;                   // of a loop
};

enum class WeldingRefusalReason {
  kGone,                   // a keyframe of the match or its map is no more, or the match says nothing new
  kCancelled,              // by the stop token
  kContradiction,          // the loop asks for more drift than the way between its ends allows
  kTooFewCommonLandmarks,  // the two sides do not see the same things
  kSidesDisagree,          // of what both see, too much does not fit
  kResidualGrew,           // the sides had to be bent too much to fit each other
};

struct WeldingRefusal {
  WeldingRefusalReason reason = WeldingRefusalReason::kGone;
  WeldingEvidence evidence;
};

// How two maps become one, or the two ends of a loop. First the edits (ApplyTolerantly), then what `correction` makes
// of the atlas as it is then (Rebase).
struct WeldingPlan {
  KeyframeId kept;  // the ends of the seam; the moved side was brought onto the kept one
  KeyframeId moved;
  MapId map;       // in which all is afterwards
  MapId absorbed;  // the map that is no more; none for a loop
  // Of a merge, MergeMaps first: with it the absorbed map lies where the seam wants it. Then fusions, observations and
  // removals, none of which moves anything, and the loop edge between the ends. Its motion is the welded one: between
  // poses as corrected, in lengths as corrected, scale 1.
  std::vector<MapEdit> edits;
  // The keyframes of the window, fixed ones left out, and their landmarks; base: the snapshot, of a merge with both
  // maps in one frame.
  Correction correction;
  // For the pose graph that takes the correction on to the rest of the map. (Of a loop it has to: the window around the
  // moved end lies where the seam wants it, and what hangs on it does not know yet.) It measures on the map before the
  // seam, which is the base of the correction, and starts from the one after it: the snapshot with edits and
  // correction. And the keyframes of the window with those that held it, which have to stay where the correction has
  // them, each with the factor by which lengths around it were multiplied.
  Atlas after_seam;
  std::map<KeyframeId, double> held;
  WeldingEvidence evidence;

  bool is_merge() const { return absorbed.valid(); }
};

using WeldingOutcome = tl::expected<WeldingPlan, WeldingRefusal>;

// Plans what a verified match makes of the atlas: a merge where its ends are in two maps, a loop where they are in one
// (also where they were in two when the match was found). Any thread, on any snapshot; `options` have passed Check().
// A requested stop gives kCancelled soon.
WeldingOutcome PlanWelding(const Atlas& snapshot, const PlaceMatch& match, const FusionOptions& options,
                           std::stop_token stop);

// Applies the edits of a plan to an atlas that has moved on since its snapshot, and returns those that were applied,
// for the journal. What does not fit any more is left out: a keypoint in use, an id gone. Without its merge nothing of
// a plan is applied.
std::vector<MapEdit> ApplyTolerantly(std::span<const MapEdit> edits, Atlas& atlas);

// One line for people: what was welded, or why not, with the figures.
std::string Describe(const WeldingPlan& plan);
std::string Describe(const WeldingRefusal& refusal);

}  // namespace pangaea
