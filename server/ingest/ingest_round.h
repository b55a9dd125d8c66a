#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/wire/atlas_event.h"
#include "server/ingest/ingest_session.h"
#include "server/ingest/journal.h"
#include "server/ingest/server_proposal.h"

namespace pangaea {

struct EnvelopeArrived {
  Envelope envelope;
  Sender sender;
};
struct SessionAnnounced {
  SessionAnnouncement announcement;
  Sender sender;
};
// A writer is gone: its agent ended, crashed or cannot be reached any more.
struct WriterLost {
  std::uint64_t writer = 0;
};
using IngestInput = std::variant<EnvelopeArrived, SessionAnnounced, WriterLost>;

// Everything the ingest knows. A value: copying it is cheap (see Atlas), and the copy is a snapshot.
struct IngestState {
  Atlas atlas;
  std::map<SessionId, IngestSession> sessions;
  std::uint64_t position = 0;    // of the newest journaled edit
  std::uint64_t correction = 0;  // of the newest edits of the server's own
  std::uint64_t refused = 0;     // messages nobody can be answered about: no session or number, or one session too many

  std::size_t living() const;  // sessions whose agents run
};

struct IngestOptions {
  // Sessions in the life of a store, against a sender that invents them. A session costs about 1 KB.
  std::size_t max_sessions = 100'000;

  Status Check() const;
};

// The atlas before edits that somebody may want to undo.
struct KeptAtlas {
  Atlas atlas;
  std::uint64_t position = 0;
};

// What a round leads to. Nothing of it may become visible before `batch` is durable.
struct IngestOutcome {
  IngestState state;
  JournalBatch batch;
  std::vector<EditAck> acks;  // one per session that sent envelopes; server_incarnation is for the shell to fill in
  std::vector<AtlasEvent> events;       // site and stamp_ns are for the shell to fill in
  std::vector<ProposalAnswer> answers;  // to the proposals, in their order
  std::vector<KeptAtlas> kept;          // snapshots to be kept, ascending by position
};

// Judges a handful of inputs, in order, on a copy of the state. Pure: no clock, no store, no network.
class IngestRound {
 public:
  // `now_unix_ns`: when sessions that join in this round joined.
  IngestRound(const IngestState& before, const IngestOptions& options, std::int64_t now_unix_ns);

  void Take(EnvelopeArrived input);
  void Take(const SessionAnnounced& input);
  void Take(const WriterLost& input);
  // All edits of a proposal count, or none.
  void Take(EditsProposed proposal);
  // Each record changed in the round and each of `unsaved` (changed in a round whose batch was not stored) is in the
  // batch.
  IngestOutcome Finish(const std::vector<SessionId>& unsaved = {}) &&;

 private:
  // What one session gets out of the round.
  struct Answer {
    bool acknowledge = false;
    bool save = false;
    std::vector<Rejection> rejections;
  };

  IngestSession* FindOrOpen(SessionId id);
  void Judge(Envelope envelope, IngestSession& session);
  ProposalAnswer JudgeProposal(EditsProposed& proposal);
  void Refuse(const Envelope& envelope, Rejection rejection, IngestSession& session);
  void ReportMaps(const std::vector<MapEdit>& edits, SessionId session);
  void Report(AtlasEventKind kind, SessionId session, std::string text);

  IngestOptions options_;
  std::int64_t now_unix_ns_;
  IngestOutcome outcome_;
  std::map<SessionId, Answer> answers_;
};

}  // namespace pangaea
