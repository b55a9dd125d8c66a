#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/map/ids.h"
#include "common/wire/edit_ack.h"
#include "common/wire/envelope.h"
#include "common/wire/session_announcement.h"

namespace pangaea {

// What is remembered of a session for ever.
struct SessionRecord {
  SessionAnnouncement announcement;  // only `session` is set while edits came but no announcement yet
  std::int64_t joined_unix_ns = 0;   // by the server's clock
  std::uint64_t acknowledged = 0;    // every envelope up to here was journaled or rejected for good
  std::uint64_t rejected = 0;
};

// An accepted envelope at its place in the common order of all edits. Positions start at 1.
struct JournalEntry {
  std::uint64_t position = 0;
  Envelope envelope;
};

// Edits of the server's own, at their place among the envelopes.
struct ServerEdits {
  std::uint64_t position = 0;
  std::string cause;             // for people, and to undo: "merge 17", "loop 4"
  std::vector<std::byte> edits;  // EncodeEdits()
};

// An envelope that was refused, and acknowledged as such.
struct JournaledRejection {
  SessionId session = 0;
  Rejection rejection;
};

// How long the server worked on something of its own.
struct WorkTime {
  std::string kind;      // "recognition", "comparison", "seam", "merge", "loop", "pose_graph", "global_bundle"
  double wall_ms = 0.0;  // milliseconds
  double cpu_ms = 0.0;   // milliseconds, of the thread that did it
  std::int64_t unix_ns = 0;
};

// What becomes durable together, or not at all.
struct JournalBatch {
  std::vector<JournalEntry> entries;
  std::vector<ServerEdits> server_edits;
  std::vector<JournaledRejection> rejections;
  std::vector<SessionRecord> sessions;  // those that changed, as they are after this batch
  std::vector<WorkTime> work_times = {};

  bool empty() const {
    return entries.empty() && server_edits.empty() && rejections.empty() && sessions.empty() && work_times.empty();
  }
};

}  // namespace pangaea
