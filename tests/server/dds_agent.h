#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/mutex.h"
#include "common/dds/participant.h"
#include "common/dds/reader.h"
#include "common/dds/waiter.h"
#include "common/dds/writer.h"

namespace pangaea {

// The least an agent is, over real DDS: announces sessions, sends envelopes and sends those again that are not
// acknowledged, and hears the status.
class DdsAgent {
 public:
  explicit DdsAgent(const std::string& site);
  ~DdsAgent();

  void Announce(const SessionAnnouncement& announcement);
  // Sends the envelopes of one session in order, those after the last ack again after a while or when the server is
  // another one, until all are acknowledged, or at least `enough` when that is not 0; then a few more are on their way.
  // Returns how many are acknowledged.
  std::uint64_t SendUntilAcknowledged(const std::vector<Envelope>& envelopes, std::uint64_t enough = 0);
  void Send(const Envelope& envelope);
  // The newest ack; none within the time.
  std::optional<EditAck> WaitForAck(SessionId session, std::uint64_t sequence, std::chrono::milliseconds patience);
  // The newest status in which `text` occurs.
  AtlasStatus WaitForStatus(const std::string& text);

 private:
  struct Links {
    Domain domain;
    Participant participant;
    Writer<SessionAnnouncement> sessions;
    Writer<Envelope> edits;
    Reader<EditAck> acks;
    Reader<AtlasStatus> status;
  };
  static Links Open(const std::string& site);

  Links links_;
  std::unique_ptr<Waiter> waiter_;
  Mutex mutex_;
  ConditionVariable changed_;
  std::map<SessionId, EditAck> acks_ GUARDED_BY(mutex_);
  AtlasStatus status_ GUARDED_BY(mutex_);
};

}  // namespace pangaea
