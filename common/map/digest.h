#pragma once

#include <cstdint>
#include <optional>
#include <set>

#include "common/map/atlas.h"

namespace pangaea {

// What a digest tells apart: lengths, and direction cosines.
inline constexpr double kDigestLength = 1e-4;
inline constexpr double kDigestRotation = 1e-5;

// A number that two atlases have in common when they hold the same: ids of keyframes, landmarks and their maps,
// observations, keyframe poses and landmark positions, quantised to 0.1 mm and 10 µrad. It does not depend on how the
// atlas came to be, nor on frames, the spanning tree or forwarding. For one map or for all.
std::uint64_t Digest(const Atlas& atlas, std::optional<MapId> map = std::nullopt);
// Of the keyframes that carry the session's ids: poses and what they observe; of the landmarks that do and that one of
// them observes: positions. It does not depend on what other sessions observe, nor on which map they are in by now: an
// agent and the server have it in common whatever the server has merged, once corrections are absorbed. A keyframe that
// is forgotten, here or (as `forgotten` says) by the agent to compare with, counts with its pose alone.
std::uint64_t DigestOfSession(const Atlas& atlas, SessionId session, const std::set<KeyframeId>& forgotten = {});

}  // namespace pangaea
