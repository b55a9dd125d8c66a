#include "tests/server/dds_agent.h"

#include <gtest/gtest.h>

#include "common/base/check.h"

namespace pangaea {
namespace {

// Longer than a commit takes on a slow machine; a loss costs this much time, never the outcome.
constexpr std::chrono::milliseconds kPatience{1000};

// How many more are on their way when enough are acknowledged.
constexpr std::uint64_t kAhead = 10;

}  // namespace

DdsAgent::Links DdsAgent::Open(const std::string& site) {
  Domain domain = Domain::Open({}).value();
  Participant participant = Participant::Open(domain, site).value();
  auto sessions = Writer<SessionAnnouncement>::Open(participant).value();
  auto edits = Writer<Envelope>::Open(participant).value();
  auto acks = Reader<EditAck>::Open(participant).value();
  auto status = Reader<AtlasStatus>::Open(participant).value();
  return {std::move(domain), std::move(participant), std::move(sessions),
          std::move(edits),  std::move(acks),        std::move(status)};
}

DdsAgent::DdsAgent(const std::string& site) : links_(Open(site)), waiter_(Waiter::Create(links_.participant).value()) {
  const auto on_ack = [this](Sample<EditAck> sample) {
    if (!sample.alive) return;
    MutexLock lock(mutex_);
    acks_[sample.value.session] = sample.value;
    changed_.notify_all();
  };
  const auto on_status = [this](Sample<AtlasStatus> sample) {
    if (!sample.alive) return;
    MutexLock lock(mutex_);
    status_ = sample.value;
    changed_.notify_all();
  };
  EXPECT_TRUE(waiter_->OnSample<EditAck>(links_.acks, on_ack));
  EXPECT_TRUE(waiter_->OnSample<AtlasStatus>(links_.status, on_status));
  waiter_->Start();
}

DdsAgent::~DdsAgent() { waiter_->Stop(); }

void DdsAgent::Announce(const SessionAnnouncement& announcement) { EXPECT_TRUE(links_.sessions.Write(announcement)); }

void DdsAgent::Send(const Envelope& envelope) { (void)links_.edits.Write(envelope); }

std::uint64_t DdsAgent::SendUntilAcknowledged(const std::vector<Envelope>& envelopes, std::uint64_t enough) {
  const SessionId session = envelopes.front().session;
  const std::uint64_t wanted = enough == 0 ? envelopes.back().sequence : enough;
  PANGAEA_CHECK(wanted <= envelopes.back().sequence);
  std::uint64_t acknowledged = 0;
  for (;;) {
    for (const Envelope& envelope : envelopes) {
      if (envelope.sequence > acknowledged && envelope.sequence <= wanted + kAhead) Send(envelope);
    }
    if (const auto ack = WaitForAck(session, wanted, kPatience)) acknowledged = ack->up_to;
    if (acknowledged >= wanted) return acknowledged;
  }
}

std::optional<EditAck> DdsAgent::WaitForAck(SessionId session, std::uint64_t sequence,
                                            std::chrono::milliseconds patience) {
  MutexLock lock(mutex_);
  changed_.wait_for(mutex_, patience, [&]() REQUIRES(mutex_) { return acks_[session].up_to >= sequence; });
  const EditAck& ack = acks_[session];
  return ack.server_incarnation == 0 ? std::nullopt : std::optional(ack);
}

AtlasStatus DdsAgent::WaitForStatus(const std::string& text) {
  MutexLock lock(mutex_);
  changed_.wait(mutex_, [&]() REQUIRES(mutex_) { return status_.json.find(text) != std::string::npos; });
  return status_;
}

}  // namespace pangaea
