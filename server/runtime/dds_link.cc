#include "server/runtime/dds_link.h"

#include <spdlog/spdlog.h>

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

Result<std::unique_ptr<DdsLink>> DdsLink::Open(const DomainOptions& options, const std::string& site, Sink sink) {
  auto domain = Domain::Open(options);
  if (!domain) return tl::make_unexpected(domain.error());
  auto participant = Participant::Open(*domain, site);
  if (!participant) return tl::make_unexpected(participant.error());
  auto sessions = Reader<SessionAnnouncement>::Open(*participant);
  if (!sessions) return tl::make_unexpected(sessions.error());
  auto edits = Reader<Envelope>::Open(*participant);
  if (!edits) return tl::make_unexpected(edits.error());
  auto acks = Writer<EditAck>::Open(*participant);
  if (!acks) return tl::make_unexpected(acks.error());
  auto events = Writer<AtlasEvent>::Open(*participant);
  if (!events) return tl::make_unexpected(events.error());
  auto status = Writer<AtlasStatus>::Open(*participant);
  if (!status) return tl::make_unexpected(status.error());
  std::unique_ptr<DdsLink> link(new DdsLink(std::move(*domain), std::move(*participant), std::move(*sessions),
                                            std::move(*edits), std::move(*acks), std::move(*events), std::move(*status),
                                            std::move(sink)));
  if (auto connected = link->Connect(); !connected) return tl::make_unexpected(connected.error());
  return link;
}

DdsLink::DdsLink(Domain domain, Participant participant, Reader<SessionAnnouncement> sessions, Reader<Envelope> edits,
                 Writer<EditAck> acks, Writer<AtlasEvent> events, Writer<AtlasStatus> status, Sink sink)
    : domain_(std::move(domain)),
      participant_(std::move(participant)),
      sessions_(std::move(sessions)),
      edits_(std::move(edits)),
      acks_(std::move(acks)),
      events_(std::move(events)),
      status_(std::move(status)),
      sink_(std::move(sink)) {}

Status DdsLink::Connect() {
  auto waiter = Waiter::Create(participant_);
  if (!waiter) return tl::make_unexpected(waiter.error());
  waiter_ = std::move(*waiter);
  const auto refused = [](const Error& error) { spdlog::warn("a message was refused: {}", error.message); };
  const auto announced = [this](Sample<SessionAnnouncement> sample) {
    if (!sample.alive) return sink_(WriterLost{sample.publication});
    sink_(SessionAnnounced{std::move(sample.value), senders_.Find(sessions_, sample.publication)});
  };
  const auto edited = [this](Sample<Envelope> sample) {
    if (!sample.alive) return sink_(WriterLost{sample.publication});
    sink_(EnvelopeArrived{std::move(sample.value), senders_.Find(edits_, sample.publication)});
  };
  if (auto status = waiter_->OnSample<SessionAnnouncement>(sessions_, announced, refused); !status) return status;
  if (auto status = waiter_->OnSample<Envelope>(edits_, edited, refused); !status) return status;
  const auto lost_announcer = [this](const MatchChange&) { SubmitLost(sessions_); };
  const auto lost_editor = [this](const MatchChange&) { SubmitLost(edits_); };
  if (auto status = waiter_->OnMatch(sessions_, lost_announcer); !status) return status;
  return waiter_->OnMatch(edits_, lost_editor);
}

void DdsLink::SubmitLost(const ReaderBase& reader) {
  for (const PublicationHandle publication : senders_.TakeLost(reader)) sink_(WriterLost{publication});
}

void DdsLink::Acknowledge(const EditAck& ack) { LogFailure(acks_.Write(ack)); }

void DdsLink::Report(const AtlasEvent& event) { LogFailure(events_.Write(event)); }

void DdsLink::Publish(const AtlasStatus& status) { LogFailure(status_.Write(status)); }

}  // namespace pangaea
