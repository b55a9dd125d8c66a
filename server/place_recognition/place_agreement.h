#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/similarity3.h"
#include "common/map/atlas.h"
#include "server/place_recognition/place_recognition_options.h"

namespace pangaea {

enum class PlaceVote { kNothing, kYes, kNo };

// What the query, or a keyframe around it, says of a motion between the query and a candidate.
struct PlaceWitness {
  KeyframeId keyframe;
  std::size_t visible = 0;          // landmarks around the candidate that it should see if the motion is right
  std::size_t found = 0;            // that it does see there
  std::size_t expected_cells = 0;   // parts of its image in which several of these should be
  std::size_t confirmed_cells = 0;  // and in which some are
  PlaceVote vote = PlaceVote::kNothing;
};

// Asks the query and its best covisible keyframes, in this order, whether they see the landmarks around the candidate
// where the motion says: those of the keyframes around the candidate that look most nearly the same way. Both keyframes
// are alive.
std::vector<PlaceWitness> AskSurroundings(const Atlas& atlas, const Keyframe& query, const Keyframe& candidate,
                                          const Similarity3d& candidate_from_query,
                                          const PlaceRecognitionOptions& options);

// Asks a frame of no map in the same way whether it sees what is around the candidate from `camera_from_map` (the
// candidate's map). Nobody around it can be asked, so it has to say yes itself.
PlaceWitness AskFrame(const Atlas& atlas, const KeyframeData& frame, const Keyframe& candidate,
                      const Rigid3d& camera_from_map, const PlaceRecognitionOptions& options);

}  // namespace pangaea
