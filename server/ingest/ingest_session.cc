#include "server/ingest/ingest_session.h"

namespace pangaea {
namespace {

// Enough for an agent to mend what it sent in one flight of envelopes; older ones stay in the store.
constexpr std::size_t kRememberedRejections = 16;

}  // namespace

bool IngestSession::Claim(const Sender& sender, std::uint64_t& writer) {
  if (owner_ != 0 && owner_ != sender.participant) {
    ++foreign_;
    return false;
  }
  // What a sender wrote before it died still counts, but nobody owns the session on its account.
  if (sender.participant == 0) return true;
  owner_ = sender.participant;
  writer = sender.writer;
  return true;
}

Admission IngestSession::Admit(std::uint64_t sequence, const Sender& sender) {
  if (!Claim(sender, editor_)) return Admission::kForeign;
  if (sequence <= record_.acknowledged) {
    ++duplicates_;
    return Admission::kDuplicate;
  }
  if (sequence > record_.acknowledged + 1) {
    ++gaps_;
    return Admission::kGap;
  }
  return Admission::kNext;
}

void IngestSession::Reject(Rejection rejection) {
  ++record_.acknowledged;
  ++record_.rejected;
  RememberRejection(std::move(rejection));
}

bool IngestSession::Announce(const SessionAnnouncement& announcement, const Sender& sender) {
  if (!Claim(sender, announcer_)) return false;
  record_.announcement = announcement;
  return true;
}

void IngestSession::LoseWriter(std::uint64_t writer) {
  if (announcer_ == writer) announcer_ = 0;
  if (editor_ == writer) editor_ = 0;
  if (announcer_ == 0 && editor_ == 0) owner_ = 0;
}

void IngestSession::RememberRejection(Rejection rejection) {
  recent_.push_back(std::move(rejection));
  if (recent_.size() > kRememberedRejections) recent_.pop_front();
}

}  // namespace pangaea
