#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/similarity3.h"
#include "common/map/atlas.h"
#include "server/place_recognition/place_recognition_options.h"

namespace pangaea {

enum class PlaceVote { kNothing, kYes, kNo };

// What a keyframe around the query says of a motion between the query and a candidate.
struct PlaceWitness {
  KeyframeId keyframe;
  std::size_t visible = 0;  // landmarks around the candidate that it should see if the motion is right
  std::size_t found = 0;    // that it does see there
  PlaceVote vote = PlaceVote::kNothing;
};

// Asks the best covisible keyframes of the query whether they see the landmarks around the candidate where the motion
// says: those of the keyframes around the candidate that look most nearly the same way. Both keyframes are alive.
std::vector<PlaceWitness> AskCovisibleKeyframes(const Atlas& atlas, const Keyframe& query, const Keyframe& candidate,
                                                const Similarity3d& candidate_from_query,
                                                const PlaceRecognitionOptions& options);

}  // namespace pangaea
