#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "common/base/result.h"
#include "common/map/atlas.h"

namespace pangaea {

struct ComparisonAgendaOptions {
  // Keyframes below which a map shows too little to be compared as a whole.
  std::size_t min_keyframes = 30;
  // A map is compared with the others when it has so many, then whenever it has grown by this factor, and when its
  // agent has ended.
  double growth = 1.5;

  Status Check() const;
};

// Which maps are to be compared with each other as wholes: those that no keyframe has joined. A value without a thread.
class ComparisonAgenda {
 public:
  explicit ComparisonAgenda(const ComparisonAgendaOptions& options) : options_(options) {}

  // Takes the maps of this atlas for compared: they were, before the server was started anew.
  void Recover(const Atlas& atlas);
  // Takes in what is new in the atlas.
  void Update(const Atlas& atlas);
  // The next pair, the map that became due first; both alive in this atlas. Nothing when all were compared.
  std::optional<std::pair<MapId, MapId>> Next(const Atlas& atlas);
  std::size_t waiting() const { return waiting_.size(); }

 private:
  // A map as it was when it was compared last.
  struct Compared {
    std::size_t keyframes = 0;
    bool closed = false;
  };
  bool IsComparable(const Atlas& atlas, MapId map) const;
  bool IsDue(const MapInfo& map) const;

  ComparisonAgendaOptions options_;
  std::map<MapId, Compared> compared_;
  std::deque<std::pair<MapId, MapId>> waiting_;
};

}  // namespace pangaea
