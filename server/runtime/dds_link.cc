#include "server/runtime/dds_link.h"

#include <spdlog/spdlog.h>

#include <bit>
#include <set>
#include <utility>

namespace pangaea {
namespace {

void LogFailure(const Status& status) {
  if (!status) spdlog::warn(status.error().message);
}

}  // namespace

Sender SenderBook::Find(const ReaderBase& reader, PublicationHandle publication) {
  auto& known = participants_[reader.entity()];
  if (const auto found = known.find(publication); found != known.end()) return {publication, found->second};
  const std::uint64_t participant = reader.ParticipantOf(publication);
  // What was written before its writer died: it is not among the living.
  if (participant != 0) known.emplace(publication, participant);
  return {publication, participant};
}

std::vector<PublicationHandle> SenderBook::TakeLost(const ReaderBase& reader) {
  const std::vector<PublicationHandle> matched = reader.MatchedPublications();
  const std::set<PublicationHandle> living(matched.begin(), matched.end());
  std::vector<PublicationHandle> lost;
  std::erase_if(participants_[reader.entity()], [&](const auto& entry) {
    if (living.contains(entry.first)) return false;
    lost.push_back(entry.first);
    return true;
  });
  return lost;
}

Result<DdsLink::Topics> DdsLink::OpenTopics(const Participant& participant) {
  auto sessions = Reader<SessionAnnouncement>::Open(participant);
  if (!sessions) return tl::make_unexpected(sessions.error());
  auto edits = Reader<Envelope>::Open(participant);
  if (!edits) return tl::make_unexpected(edits.error());
  auto interests = Reader<MapInterest>::Open(participant);
  if (!interests) return tl::make_unexpected(interests.error());
  auto requests = Reader<RelocalizationRequest>::Open(participant);
  if (!requests) return tl::make_unexpected(requests.error());
  auto acks = Writer<EditAck>::Open(participant);
  if (!acks) return tl::make_unexpected(acks.error());
  auto corrections = Writer<CorrectionPart>::Open(participant);
  if (!corrections) return tl::make_unexpected(corrections.error());
  auto answers = Writer<RelocalizationAnswer>::Open(participant);
  if (!answers) return tl::make_unexpected(answers.error());
  auto events = Writer<AtlasEvent>::Open(participant);
  if (!events) return tl::make_unexpected(events.error());
  auto status = Writer<AtlasStatus>::Open(participant);
  if (!status) return tl::make_unexpected(status.error());
  auto undos = Reader<UndoRequest>::Open(participant);
  if (!undos) return tl::make_unexpected(undos.error());
  auto undo_answers = Writer<UndoAnswer>::Open(participant);
  if (!undo_answers) return tl::make_unexpected(undo_answers.error());
  return Topics{std::move(*sessions), std::move(*edits),       std::move(*interests),   std::move(*requests),
                std::move(*acks),     std::move(*corrections), std::move(*answers),     std::move(*events),
                std::move(*status),   std::move(*undos),       std::move(*undo_answers)};
}

Result<std::unique_ptr<DdsLink>> DdsLink::Open(const DomainOptions& options, const std::string& site, Sinks sinks) {
  auto domain = Domain::Open(options);
  if (!domain) return tl::make_unexpected(domain.error());
  auto participant = Participant::Open(*domain, site);
  if (!participant) return tl::make_unexpected(participant.error());
  auto topics = OpenTopics(*participant);
  if (!topics) return tl::make_unexpected(topics.error());
  std::unique_ptr<DdsLink> link(
      new DdsLink(std::move(*domain), std::move(*participant), std::move(*topics), std::move(sinks)));
  if (auto connected = link->Connect(); !connected) return tl::make_unexpected(connected.error());
  return link;
}

DdsLink::DdsLink(Domain domain, Participant participant, Topics topics, Sinks sinks)
    : domain_(std::move(domain)),
      participant_(std::move(participant)),
      topics_(std::move(topics)),
      sinks_(std::move(sinks)) {}

Status DdsLink::Connect() {
  auto waiter = Waiter::Create(participant_);
  if (!waiter) return tl::make_unexpected(waiter.error());
  waiter_ = std::move(*waiter);
  const auto refused = [](const Error& error) { spdlog::warn("a message was refused: {}", error.message); };
  const auto announced = [this](Sample<SessionAnnouncement> sample) {
    if (!sample.alive) return sinks_.ingest(WriterLost{sample.publication});
    sinks_.ingest(SessionAnnounced{std::move(sample.value), senders_.Find(topics_.sessions, sample.publication)});
  };
  const auto edited = [this](Sample<Envelope> sample) {
    if (!sample.alive) return sinks_.ingest(WriterLost{sample.publication});
    sinks_.ingest(EnvelopeArrived{std::move(sample.value), senders_.Find(topics_.edits, sample.publication)});
  };
  const auto interested = [this](Sample<MapInterest> sample) {
    if (sample.alive) sinks_.interest(std::move(sample.value));
  };
  const auto refused_question = [this](const Error& error) {
    if (std::has_single_bit(++refused_questions_)) sinks_.refused_question(error);
  };
  const auto asked = [this](Sample<RelocalizationRequest> sample) {
    if (!sample.alive) return;
    sinks_.question({std::move(sample.value), senders_.Find(topics_.requests, sample.publication)});
  };
  if (auto status = waiter_->OnSample<SessionAnnouncement>(topics_.sessions, announced, refused); !status)
    return status;
  if (auto status = waiter_->OnSample<Envelope>(topics_.edits, edited, refused); !status) return status;
  if (auto status = waiter_->OnSample<MapInterest>(topics_.interests, interested, refused); !status) return status;
  if (auto status = waiter_->OnSample<RelocalizationRequest>(topics_.requests, asked, refused_question); !status)
    return status;
  const auto lost_asker = [this](const MatchChange&) { senders_.TakeLost(topics_.requests); };
  if (auto status = waiter_->OnMatch(topics_.requests, lost_asker); !status) return status;
  const auto wants_undo = [this](Sample<UndoRequest> sample) {
    if (sample.alive) sinks_.undo(std::move(sample.value));
  };
  if (auto status = waiter_->OnSample<UndoRequest>(topics_.undos, wants_undo, refused); !status) return status;
  const auto lost_announcer = [this](const MatchChange&) { SubmitLost(topics_.sessions); };
  const auto lost_editor = [this](const MatchChange&) { SubmitLost(topics_.edits); };
  if (auto status = waiter_->OnMatch(topics_.sessions, lost_announcer); !status) return status;
  return waiter_->OnMatch(topics_.edits, lost_editor);
}

void DdsLink::SubmitLost(const ReaderBase& reader) {
  for (const PublicationHandle publication : senders_.TakeLost(reader)) sinks_.ingest(WriterLost{publication});
}

void DdsLink::Acknowledge(const EditAck& ack) { LogFailure(topics_.acks.Write(ack)); }

void DdsLink::Report(const AtlasEvent& event) { LogFailure(topics_.events.Write(event)); }

void DdsLink::Publish(const AtlasStatus& status) { LogFailure(topics_.status.Write(status)); }

void DdsLink::Answer(const UndoAnswer& answer) { LogFailure(topics_.undo_answers.Write(answer)); }

void DdsLink::Send(const CorrectionPart& part) { LogFailure(topics_.corrections.Write(part)); }

void DdsLink::Answer(const RelocalizationAnswer& answer) { LogFailure(topics_.answers.Write(answer)); }

}  // namespace pangaea
