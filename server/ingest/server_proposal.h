#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "common/wire/atlas_event.h"

namespace pangaea {

// Why the server changes maps by itself, for people, and to undo it: "merge 17", "loop 23", "culling 40". The number is
// the position in the journal of the first edits with this cause, so a cause is unique for ever; what belongs to it
// later (the pose graph of a merge) carries the same.
struct Cause {
  std::string kind;
  std::uint64_t number = 0;  // 0: these are the first edits

  std::string Text() const { return kind + " " + std::to_string(number); }
};

// The atlas as it becomes while edits of the server's own are made of it.
class ServerDraft {
 public:
  // `position`: that of the edits in the journal, by which their moves and merges say which correction they are.
  ServerDraft(const Atlas& atlas, std::uint64_t position) : atlas_(atlas), position_(position) {}

  const Atlas& atlas() const { return atlas_; }
  // Applies an edit. What does not fit changes nothing.
  Status Try(MapEdit edit);
  const std::vector<MapEdit>& edits() const { return edits_; }

 private:
  Atlas atlas_;
  std::uint64_t position_;
  std::vector<MapEdit> edits_;  // that were applied
};

// Edits of the server's own, as its background work wants them.
struct EditsProposed {
  Cause cause;
  // Makes the edits of the atlas as it is when they are judged: what they were planned on may be long past. Quick, as
  // the ingest waits for it. An error: they make no sense any more, and nothing changes. None: there is nothing to
  // change.
  std::function<Status(ServerDraft& draft)> make;
  // For people, once the edits are durable; "<cause>: " is put before its text.
  std::optional<AtlasEvent> event = {};
  // The atlas as it was before is kept as a snapshot, from which the cause can be undone.
  bool keep_before = false;
};

// What became of a proposal.
struct EditsTaken {
  Cause cause;
  std::uint64_t position = 0;  // in the journal; 0 where there was nothing to change
  std::size_t edits = 0;
};
using ProposalAnswer = Result<EditsTaken>;

// Moves and merges of the server's own say which correction they are: their position in the journal.
void StampCorrections(std::uint64_t position, std::vector<MapEdit>& edits);

}  // namespace pangaea
