#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"

namespace pangaea {

struct LookupOptions {
  // So many of the newest keyframes of a session are looked up in the order they came, sessions in turn. Where more
  // wait, the older ones wait until no session has newer ones: in a burst, where agents are now counts. Nothing is left
  // out: of two keyframes that show one place, the one that is looked up later finds the other.
  std::size_t recent = 8;

  Status Check() const;
};

// Which keyframes have to be looked up next: each once, in bounded memory (the atlas itself bounds it). A value without
// a thread.
class LookupAgenda {
 public:
  explicit LookupAgenda(const LookupOptions& options) : options_(options) {}

  // Takes in what is new in the atlas. Returns the keyframes that are gone since.
  std::vector<KeyframeId> Update(const Atlas& atlas);
  // The next keyframe, which from now on counts as looked up. Nothing when all were.
  std::optional<KeyframeId> Next();
  // Puts one back that shows too few landmarks in this atlas to be looked up: its turn comes again, behind all others,
  // when Update has seen more of them.
  void Defer(const Atlas& atlas, KeyframeId id);
  std::size_t waiting() const;

 private:
  std::vector<KeyframeId> DropVanished(const Atlas& atlas);
  void ResumeDeferred(const Atlas& atlas);
  void Enter(KeyframeId id);

  LookupOptions options_;
  std::set<KeyframeId> known_;
  std::map<SessionId, std::deque<KeyframeId>> recent_;  // ascending; none empty
  std::deque<KeyframeId> backlog_;                      // the next at the back
  std::map<KeyframeId, std::size_t> deferred_;          // and how many landmarks they showed
  SessionId served_ = 0;                                // whose turn it was
};

}  // namespace pangaea
