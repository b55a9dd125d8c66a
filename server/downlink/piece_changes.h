#pragma once

#include <set>
#include <vector>

#include "common/map/atlas.h"

namespace pangaea {

// What of the atlas a receiver knows: the state it was last told of, or nothing.
struct KnownState {
  const Atlas* atlas = nullptr;  // none: it was told nothing that is remembered
  std::uint64_t version = 0;     // corrections up to this one are part of what it knows
};

// Landmarks that the keyframes observe and that are not as the receiver knows them, ascending: new to it, seen by
// others, measured from another reference, or elsewhere in the camera frame of their reference; and those that the
// receiver believes they observe while they do not any more, of whatever map. Nothing known: those of
// keyframes that a correction has placed, and all of `fresh`. Of keyframes that are `fresh` to it, all.
std::vector<LandmarkId> ChangedLandmarks(const Atlas& atlas, const KnownState& known,
                                         const std::vector<KeyframeId>& keyframes, const std::set<KeyframeId>& fresh);

// Landmarks of the session (and of any session, as far as the receiver knew them) that live no more and that it may
// hold: those that lived in what it knows, those that it added in vain since. Nothing known: all of the session, since
// who removed them, it or the server, is not remembered.
std::vector<LandmarkId> FormerLandmarks(const Atlas& atlas, const KnownState& known, SessionId session);

// Keyframes of the session of the same kind, and `held` ones that are gone.
std::vector<KeyframeId> GoneKeyframes(const Atlas& atlas, const KnownState& known, SessionId session,
                                      const std::vector<KeyframeId>& held);

}  // namespace pangaea
