#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/map/atlas.h"
#include "common/mapping/guided_location.h"
#include "common/mapping/position_observability.h"
#include "common/mapping/relocalization.h"
#include "common/place/inverted_index.h"
#include "common/place/vocabulary_tree.h"
#include "server/place_recognition/place_recognition_options.h"

namespace pangaea {

// How a frame without any map is found in the atlas.
struct FrameLookupOptions {
  PlaceQueryOptions query = {.candidates = 12};
  RelocalizationOptions relocalization;
  std::size_t at_once = 3;  // candidates compared before what they give is looked at
  // Keyframes around a candidate, itself included, whose landmarks the frame is compared with where no candidate's own
  // lead to a place.
  std::size_t candidate_window = 6;
  std::size_t window = 30;  // keyframes whose landmarks are looked for then: as an agent's local map
  GuidedSearchOptions guided;
  // As an agent believes a place after a loss: a wrong one costs more than none.
  int min_inliers = 30;
  double min_agreement = 0.5;  // share of the landmarks found that agree with the pose
  ObservabilityOptions observability;
  std::uint64_t seed = 1;

  Status Check() const;
};

// How a lookup ended: found, or the farthest step that a candidate came to.
enum class FrameOutcome {
  kFewFeatures,   // nothing to compare
  kNoCandidate,   // nothing in the index looks like it, in a map that the frame's camera can go on in
  kNoPose,        // no candidate's landmarks give one
  kFewInliers,    // too few landmarks around agree with the pose
  kUnobservable,  // they leave the position uncertain
  kContradicted,  // parts of the image do not show what they should
  kFound,
};
// For logs and events: "few inliers".
std::string_view ToString(FrameOutcome outcome);

struct FrameLookup {
  FrameOutcome outcome = FrameOutcome::kFewFeatures;
  std::size_t candidates = 0;  // keyframes that look like the frame
  // Of the candidate that came farthest, from kFewInliers on.
  KeyframeId keyframe{};
  MapId map{};
  Rigid3d camera_from_keyframe{};   // camera frame of `keyframe` (lengths of its map) to that of the frame
  int inliers = 0;                  // landmarks that the pose rests on
  int found = 0;                    // ... of so many that were found
  std::size_t expected_cells = 0;   // parts of the image that should show something of the place
  std::size_t confirmed_cells = 0;  // and do

  bool is_found() const { return outcome == FrameOutcome::kFound; }
};

// Where in the atlas was this frame taken (Elvira et al. 2019, "Relocalization in multiple maps")? Words → candidates
// in all maps → three-point RANSAC → guided search around → pose; the frame needs no depth. Believed with enough
// landmarks that agree, a position that is certain, and when all parts of the image have a say (place_agreement.h). A
// camera that measures depth is looked for in metric maps alone: it could not go on in another. `index` may know
// keyframes that the atlas does not. Deterministic.
FrameLookup LookUpFrame(const Atlas& atlas, const InvertedIndex& index, const VocabularyTree& vocabulary,
                        const KeyframeData& frame, const FrameLookupOptions& options,
                        const PlaceRecognitionOptions& place);

}  // namespace pangaea
