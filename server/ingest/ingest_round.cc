#include "server/ingest/ingest_round.h"

#include <algorithm>
#include <utility>

#include "common/map/map_edit.h"
#include "server/ingest/agent_edit.h"
#include "server/ingest/envelope_judgement.h"

namespace pangaea {
namespace {

std::string NameOf(const IngestSession& session) {
  const SessionAnnouncement& announcement = session.record().announcement;
  return announcement.name.empty() ? ToString(announcement.session) : announcement.name;
}

}  // namespace

std::size_t IngestState::living() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(sessions, [](const auto& entry) { return entry.second.alive(); }));
}

Status IngestOptions::Check() const {
  if (max_sessions >= 1) return {};
  return Fail(ErrorCode::kInvalidArgument, "max_sessions is 0; at least 1 is needed");
}

IngestRound::IngestRound(const IngestState& before, const IngestOptions& options, std::int64_t now_unix_ns)
    : options_(options), now_unix_ns_(now_unix_ns) {
  outcome_.state = before;
}

void IngestRound::Take(EnvelopeArrived input) {
  Envelope& envelope = input.envelope;
  IngestSession* session = envelope.sequence == 0 ? nullptr : FindOrOpen(envelope.session);
  if (session == nullptr) {
    ++outcome_.state.refused;
    return;
  }
  const bool first_foreign = session->foreign() == 0;
  const Admission admission = session->Admit(envelope.sequence, input.sender);
  if (admission == Admission::kForeign) {
    // Once a session: a sender that goes on for hours must not flood the events.
    if (first_foreign) Report(AtlasEventKind::kRejected, envelope.session, "edits of a sender that does not own it");
    return;
  }
  Answer& answer = answers_[envelope.session];
  // Earlier rejections go with every ack: an agent that missed one would believe that its envelope was taken.
  if (!std::exchange(answer.acknowledge, true)) answer.rejections = session->RecentRejections();
  if (admission == Admission::kNext) Judge(std::move(envelope), *session);
}

void IngestRound::Take(const SessionAnnounced& input) {
  const SessionAnnouncement& announcement = input.announcement;
  IngestSession* session = FindOrOpen(announcement.session);
  if (session == nullptr) {
    ++outcome_.state.refused;
    return;
  }
  const bool was_alive = session->alive();
  const bool was_named = !session->record().announcement.name.empty();
  const bool was_closed = session->record().announcement.closed;
  const bool first_foreign = session->foreign() == 0;
  if (!session->Announce(announcement, input.sender)) {
    if (first_foreign) Report(AtlasEventKind::kRejected, announcement.session, "announced by one that does not own it");
    return;
  }
  answers_[announcement.session].save = true;
  if (announcement.closed && !was_closed) {
    Report(AtlasEventKind::kSessionClosed, announcement.session, NameOf(*session) + " ended");
  } else if (session->alive() && !(was_alive && was_named)) {
    Report(AtlasEventKind::kSessionJoined, announcement.session, NameOf(*session) + " joined");
  }
}

void IngestRound::Take(const WriterLost& input) {
  for (auto& [id, session] : outcome_.state.sessions) {
    const bool was_alive = session.alive();
    session.LoseWriter(input.writer);
    if (was_alive && !session.alive()) Report(AtlasEventKind::kSessionLost, id, NameOf(session) + " vanished");
  }
}

void IngestRound::Take(EditsProposed proposal) { outcome_.answers.push_back(JudgeProposal(proposal)); }

IngestOutcome IngestRound::Finish(const std::vector<SessionId>& unsaved) && {
  for (const SessionId id : unsaved) answers_[id].save = true;
  for (auto& [id, answer] : answers_) {
    const IngestSession& session = outcome_.state.sessions.at(id);
    if (answer.save) outcome_.batch.sessions.push_back(session.record());
    if (!answer.acknowledge) continue;
    outcome_.acks.push_back({id, session.record().acknowledged, 0, std::move(answer.rejections)});
  }
  return std::move(outcome_);
}

IngestSession* IngestRound::FindOrOpen(SessionId id) {
  auto& sessions = outcome_.state.sessions;
  if (const auto found = sessions.find(id); found != sessions.end()) return &found->second;
  if (id == 0 || sessions.size() >= options_.max_sessions) return nullptr;
  SessionRecord record;
  record.announcement.session = id;
  record.joined_unix_ns = now_unix_ns_;
  answers_[id].save = true;
  return &sessions.emplace(id, IngestSession(std::move(record))).first->second;
}

void IngestRound::Judge(Envelope envelope, IngestSession& session) {
  const auto edits = JudgeContent(envelope);
  if (!edits) return Refuse(envelope, {envelope.sequence, edits.error().reason, edits.error().text}, session);
  auto atlas = ApplyWhole(*edits, outcome_.state.atlas, &ApplyAgentEdit);
  if (!atlas) return Refuse(envelope, {envelope.sequence, atlas.error().reason, atlas.error().text}, session);
  outcome_.state.atlas = std::move(*atlas);
  session.Accept();
  answers_[envelope.session].save = true;
  ReportMaps(*edits, envelope.session);
  for (const MapEdit& edit : *edits) {
    if (std::holds_alternative<CloseMap>(edit)) session.CloseMap();
  }
  outcome_.batch.entries.push_back({++outcome_.state.position, std::move(envelope)});
}

ProposalAnswer IngestRound::JudgeProposal(EditsProposed& proposal) {
  IngestState& state = outcome_.state;
  const std::uint64_t position = state.position + 1;
  ServerDraft draft(state.atlas, position);
  if (auto status = proposal.make(draft); !status) return tl::make_unexpected(std::move(status.error()));
  Cause cause = std::move(proposal.cause);
  const std::size_t count = draft.edits().size();
  if (count == 0) return EditsTaken{std::move(cause), 0, 0};
  // What was applied is what recovery will read: it is exact in this form.
  std::vector<std::byte> encoded = EncodeEdits(draft.edits());
  if (const auto readable = DecodeEdits(encoded); !readable) return tl::make_unexpected(readable.error());
  if (proposal.keep_before) outcome_.kept.push_back({state.atlas, state.position});
  if (cause.number == 0) cause.number = position;
  state.atlas = draft.atlas();
  state.position = state.correction = position;
  outcome_.batch.server_edits.push_back({position, cause.Text(), std::move(encoded)});
  if (proposal.event) Report(proposal.event->kind, proposal.event->session, cause.Text() + ": " + proposal.event->text);
  return EditsTaken{std::move(cause), position, count};
}

void IngestRound::Refuse(const Envelope& envelope, Rejection rejection, IngestSession& session) {
  Report(AtlasEventKind::kRejected, envelope.session,
         NameOf(session) + ": envelope " + std::to_string(envelope.sequence) + ": " + rejection.text);
  outcome_.batch.rejections.push_back({envelope.session, rejection});
  Answer& answer = answers_[envelope.session];
  answer.save = true;
  answer.rejections.push_back(rejection);
  session.Reject(std::move(rejection));
}

void IngestRound::ReportMaps(const std::vector<MapEdit>& edits, SessionId session) {
  for (const MapEdit& edit : edits) {
    if (const auto* keyframe = std::get_if<AddKeyframe>(&edit); keyframe != nullptr && !keyframe->parent.valid()) {
      Report(AtlasEventKind::kNewMap, session, "map " + ToString(keyframe->map));
    }
    if (const auto* closed = std::get_if<CloseMap>(&edit)) {
      Report(AtlasEventKind::kMapClosed, session, "map " + ToString(closed->map));
    }
  }
}

void IngestRound::Report(AtlasEventKind kind, SessionId session, std::string text) {
  AtlasEvent event;
  event.kind = kind;
  event.session = session;
  event.text = std::move(text);
  outcome_.events.push_back(std::move(event));
}

}  // namespace pangaea
