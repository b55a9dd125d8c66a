#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "common/base/result.h"
#include "common/map/atlas.h"

namespace pangaea {

struct ComparisonAgendaOptions {
  // Keyframes below which a map shows too little to be compared as a whole.
  std::size_t min_keyframes = 20;

  Status Check() const;
};

// Which maps are to be compared with each other as wholes: each when it is over, that is closed by its agent or left by
// it, with all that no keyframe has joined it with. While it grows, a part of it may look like a whole. A value without a
// thread.
class ComparisonAgenda {
 public:
  explicit ComparisonAgenda(const ComparisonAgendaOptions& options) : options_(options) {}

  // Takes the maps of this atlas for compared: they were, before the server was started anew.
  void Recover(const Atlas& atlas);
  // Takes in what is new. `is_left`: no agent works on the map any more.
  void Update(const Atlas& atlas, const std::function<bool(MapId)>& is_left);
  // The next pair, of the map that was over first; both alive in this atlas. Nothing when all were compared.
  std::optional<std::pair<MapId, MapId>> Next(const Atlas& atlas);
  std::size_t waiting() const { return waiting_.size(); }

 private:
  bool IsComparable(const Atlas& atlas, MapId map) const;

  ComparisonAgendaOptions options_;
  std::map<MapId, std::size_t> compared_;  // and how many keyframes it had then
  std::deque<std::pair<MapId, MapId>> waiting_;
};

}  // namespace pangaea
