#pragma once

#include <unordered_set>

#include "common/map/atlas.h"
#include "common/place/inverted_index.h"
#include "server/place_recognition/place_recognition_options.h"

namespace pangaea {

// The keyframes that may not be candidates of this one: itself, those it shares a landmark with, and those that share
// options.min_shared landmarks with one of these. Where the trajectory has not left a place, or the map already knows
// that it came back, there is nothing to recognise, however much time has passed.
std::unordered_set<KeyframeId> Surroundings(const Atlas& atlas, const Keyframe& query,
                                            const PlaceCandidateOptions& options);

// The candidates to verify, best first: of those that see a common landmark the best alone. At most options.places.
std::vector<PlaceCandidate> BestOfEachPlace(const Atlas& atlas, const std::vector<PlaceCandidate>& ranked,
                                            const PlaceCandidateOptions& options);

}  // namespace pangaea
