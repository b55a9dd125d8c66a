#pragma once

#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "server/ingest/journal.h"

namespace pangaea {

// Where a message came from. Numbers of the network layer, valid while it runs; 0 is none.
struct Sender {
  std::uint64_t writer = 0;       // the DDS publication
  std::uint64_t participant = 0;  // the process behind it; 0 once it is gone: such a sender claims nothing
};

enum class Admission {
  kNext,       // the envelope that is due: judge it
  kDuplicate,  // it is durable already (or was rejected): acknowledge again
  kGap,        // earlier ones are missing: acknowledge what is there, the agent goes back
  kForeign,    // another live participant owns the session: ignored, no answer
};

// The order of one session's envelopes and who may speak for it: the first live participant that announced it or sent
// edits for it, until its writers are lost. A value: a round works on a copy of it.
class IngestSession {
 public:
  explicit IngestSession(SessionRecord record) : record_(std::move(record)) {}

  // Decides about an envelope by its number and sender alone.
  Admission Admit(std::uint64_t sequence, const Sender& sender);
  void Accept() { ++record_.acknowledged; }
  void CloseMap() { ++closed_maps_; }
  void Reject(Rejection rejection);

  // False when another live participant owns the session: the announcement is ignored.
  bool Announce(const SessionAnnouncement& announcement, const Sender& sender);
  void LoseWriter(std::uint64_t writer);

  const SessionRecord& record() const { return record_; }
  // Its agent runs: one of its writers is there, and it did not say that it ended.
  bool alive() const { return owner_ != 0 && !record_.announcement.closed; }
  // One that is gone by now owns nothing.
  bool IsOwnedBy(const Sender& sender) const { return owner_ != 0 && owner_ == sender.participant; }
  // For agents that missed an ack: the newest rejections, oldest first.
  std::vector<Rejection> RecentRejections() const { return {recent_.begin(), recent_.end()}; }
  void RememberRejection(Rejection rejection);

  // How often its agent has said, since the server started, that nothing more comes to one of its maps.
  std::uint64_t closed_maps() const { return closed_maps_; }
  std::uint64_t duplicates() const { return duplicates_; }
  std::uint64_t gaps() const { return gaps_; }
  std::uint64_t foreign() const { return foreign_; }

 private:
  bool Claim(const Sender& sender, std::uint64_t& writer);

  SessionRecord record_;
  std::uint64_t owner_ = 0;      // participant
  std::uint64_t announcer_ = 0;  // its writer of announcements
  std::uint64_t editor_ = 0;     // its writer of edits
  std::deque<Rejection> recent_;
  std::uint64_t closed_maps_ = 0;
  std::uint64_t duplicates_ = 0;
  std::uint64_t gaps_ = 0;
  std::uint64_t foreign_ = 0;
};

}  // namespace pangaea
