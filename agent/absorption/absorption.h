#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "common/map/map_piece.h"

namespace pangaea {

// Who absorbs what.
struct AbsorptionInput {
  SessionId session = 0;
  std::uint64_t version = 0;  // of the correction
  // What the server had of this session's envelopes when it cut the pieces, as it was here: what it had been told and
  // what earlier corrections said. Tells what the server changed since from what the agent did.
  const Atlas& base;
  std::span<const MapPiece> pieces;
  // The pieces list all that the session's keyframes observe, and what is otherwise in the atlas gives way: the agent
  // did nothing that they do not know (AgentCorrection::complete).
  bool complete = false;
};

struct Absorption {
  std::vector<MapEdit> edits;  // each valid after those before it
  Atlas after;                 // all of them applied
};

// The edits by which an atlas of the agent (its own, or one of what the server has) takes in what the server says:
//  - maps that the server joined are joined, and all poses move into the frame of the server's map;
//  - keyframes that a correction has placed take the server's pose and are the server's from then on; others that moved
//    keep what the agent moved them since, on top; keyframes it says nothing of (it does not know them yet) follow
//    their parent, landmarks their reference keyframe;
//  - landmarks that the server made one become one, and it decides who observes what as far as the agent has not
//    changed that since; what the server removed goes;
//  - keyframes that were forgotten here and that the piece brings are as before;
//  - keyframes and landmarks that are new here (guests) hang below a keyframe of the session. Where the session has
//    none in that map, they make a map of their own, under the server's id.
// Guests and what the server has placed are read-only to local mapping: see IsReadOnly. What does not fit the atlas
// any more is left out.
Absorption PlanAbsorption(const Atlas& atlas, const AbsorptionInput& input);

// The move that brings a landmark exactly there; none for a point that no edit can carry.
std::optional<MovedLandmark> MeasureLandmark(const Atlas& atlas, const Landmark& landmark,
                                             const Eigen::Vector3d& point_in_map);

// Whether the agent of `session` leaves the keyframe where it is.
bool IsReadOnly(const Keyframe& keyframe, SessionId session);
// ... and the landmark: another session's, or measured from a keyframe that is read-only.
bool IsReadOnly(const Atlas& atlas, const Landmark& landmark, SessionId session);

}  // namespace pangaea
