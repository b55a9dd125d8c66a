#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

// Rebuilds an atlas without the edits of one cause. What the server changed later in the maps concerned was made for
// the atlas with them (poses optimised on a merged map), and is left out as well: recognition and optimisation do it
// anew. What agents sent is kept as far as it makes sense: a keyframe stays with its parent, other edits that do not
// fit are left out. A value: no file, no clock.
class UndoReplay {
 public:
  // `atlas`: from before the first edits of the cause.
  UndoReplay(Atlas atlas, std::string cause) : atlas_(std::move(atlas)), cause_(std::move(cause)) {}

  // In the order of the journal.
  void TakeAgents(const std::vector<MapEdit>& edits);
  // False: these edits are left out.
  bool TakeServers(const std::vector<MapEdit>& edits, const std::string& cause);

  const Atlas& atlas() const { return atlas_; }
  // The maps concerned, as they are called in the rebuilt atlas.
  const std::set<MapId>& touched() const { return touched_; }
  // Pairs that the cause merged, as they are called in the rebuilt atlas.
  const std::vector<std::pair<MapId, MapId>>& separated() const { return separated_; }
  const std::set<std::string>& also() const { return also_; }  // causes left out because they built on it
  std::size_t misfits() const { return misfits_; }             // edits of agents that were left out

 private:
  void TakeTolerantly(const MapEdit& edit);
  std::set<MapId> MapsOf(const std::vector<MapEdit>& edits) const;

  Atlas atlas_;
  std::string cause_;
  std::set<MapId> touched_;
  std::vector<std::pair<MapId, MapId>> separated_;
  std::set<std::string> also_;
  std::size_t misfits_ = 0;
};

}  // namespace pangaea
