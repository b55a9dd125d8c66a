#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "server/ingest/ingest_round.h"

namespace pangaea {

struct ComparisonAgendaOptions {
  // Keyframes below which a map shows too little to be compared as a whole.
  std::size_t min_keyframes = 20;

  Status Check() const;
};

// The maps in which a living session has a part.
std::set<MapId> MapsInWork(const IngestState& state);

// Which maps are to be compared with each other as wholes: two that no keyframe has joined and that are both over, that
// is closed by their agents or left by them, when the later of them is. While a map grows, a part of it may look like a
// whole. A value without a thread.
class ComparisonAgenda {
 public:
  explicit ComparisonAgenda(const ComparisonAgendaOptions& options) : options_(options) {}

  // Takes the closed maps of this atlas for compared with each other, before the first Update: mostly they were, before
  // the server was started anew, and to compare all of them again at each start would cost too much.
  void Recover(const Atlas& atlas);
  // Takes in what is new. `is_left`: no agent works on the map any more.
  void Update(const Atlas& atlas, const std::function<bool(MapId)>& is_left);
  // The next pair, of the map that was over first; both alive in this atlas and over at the last Update. Nothing when
  // all were compared.
  std::optional<std::pair<MapId, MapId>> Next(const Atlas& atlas);
  std::size_t waiting() const { return waiting_.size(); }

 private:
  bool IsComparable(const Atlas& atlas, MapId map) const;
  bool Waits(MapId a, MapId b) const;

  ComparisonAgendaOptions options_;
  std::map<MapId, std::size_t> compared_;  // and how many keyframes are left of those that it had then
  std::set<MapId> over_;                   // of those that show enough
  std::deque<std::pair<MapId, MapId>> waiting_;
};

}  // namespace pangaea
