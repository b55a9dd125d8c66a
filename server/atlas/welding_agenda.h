#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "server/place_recognition/place_match.h"

namespace pangaea {

struct WeldingAgendaOptions {
  // Matches that may wait. Beyond, the oldest loop goes, and without loops the oldest match: places that are seen again
  // are recognised again.
  std::size_t capacity = 64;
  // Keyframes that share so many landmarks are joined already: a match between them says nothing new.
  std::uint32_t joined_landmarks = 15;

  Status Check() const;
};

// Maps that an operator took apart: they are not to be merged again.
using Separations = std::vector<std::pair<MapId, MapId>>;

// Verified matches in the order in which they become merges and loops: one at a time, merges first, and each seen in
// the light of what happened since it was found. A value without a thread.
class WeldingAgenda {
 public:
  WeldingAgenda(const WeldingAgendaOptions& options, Separations separations)
      : options_(options), separations_(std::move(separations)) {}

  void Add(PlaceMatch match);
  // The match to weld now. Matches without sense in this atlas are dropped: a keyframe or its map is gone, what they
  // join is joined already, or was separated by hand. Loops in maps that `waits` names stay for later.
  std::optional<PlaceMatch> Next(const Atlas& atlas, const std::function<bool(MapId)>& waits);
  std::size_t waiting() const { return matches_.size(); }
  std::uint64_t dropped() const { return dropped_; }

 private:
  enum class Sense { kNone, kLoop, kMerge };
  Sense SenseOf(const PlaceMatch& match, const Atlas& atlas) const;
  bool AreSeparated(MapId a, MapId b, const Atlas& atlas) const;

  WeldingAgendaOptions options_;
  Separations separations_;
  std::deque<PlaceMatch> matches_;  // as they were found
  std::uint64_t dropped_ = 0;
};

}  // namespace pangaea
