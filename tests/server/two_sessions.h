#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "server/downlink/session_downlink.h"
#include "tests/map/small_world.h"

namespace pangaea {

// Anna's row of three, and Bert's map of two keyframes with a landmark that both see.
inline SmallWorld TwoSessions() {
  SmallWorld world = RowOfThree();
  world.Root(K(1, kBert), M(1, kBert));
  world.Child(K(2, kBert), K(1, kBert), M(1, kBert));
  world.Add(L(1, kBert), K(1, kBert), 1);
  world.Observe(L(1, kBert), K(2, kBert), 1);
  return world;
}

// The server merges Bert's map into Anna's and finds that two landmarks are one.
inline void Merge(SmallWorld& world, std::uint64_t position) {
  world.Do(MergeMaps{M(1), M(1, kBert), {}, K(1, kBert), K(1), position});
  world.Do(FuseLandmarks{L(1), L(1, kBert)});
}

inline SessionView View(const SmallWorld& world, std::uint64_t position, std::uint64_t correction) {
  return {world.atlas, position, correction, 7};
}

// The version of the first correction that is cut at this position of the journal.
inline std::uint64_t First(std::uint64_t position) { return 1024 * position; }

inline MapInterest Interest(SessionId session, std::uint64_t applied, std::vector<KeyframeId> guests = {}) {
  return {session, applied, M(1, session), K(1, session), std::move(guests)};
}

// After the merge at position 10, of which Bert's agent was not told yet.
struct MergedForBert {
  explicit MergedForBert(const GuestOptions& options = {}) : downlink(kBert, options) {
    Merge(world, 10);
    downlink.Take(Interest(kBert, 0));
  }
  SmallWorld world = TwoSessions();
  SessionDownlink downlink;
};

inline std::vector<KeyframeId> Ids(const MapPiece& piece) {
  std::vector<KeyframeId> ids;
  for (const PieceKeyframe& keyframe : piece.keyframes) ids.push_back(keyframe.id);
  return ids;
}

}  // namespace pangaea
