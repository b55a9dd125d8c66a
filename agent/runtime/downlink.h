#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "agent/runtime/uplink_thread.h"
#include "agent/uplink/edit_stream.h"
#include "common/base/mutex.h"
#include "common/wire/agent_correction.h"
#include "common/wire/edit_ack.h"

namespace pangaea {

// Hands corrections from the uplink thread, where they arrive, to mapping, which absorbs them: one at a time, each when
// the acks are as far as the server was when it made it.
class Downlink {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // The uplink thread alone.
  Status Receive(CorrectionPart part, const EditStream& stream);
  void OnAck(const EditAck& ack) EXCLUDES(mutex_);
  void OnServerLost() EXCLUDES(mutex_);
  // The server was asked whether this claim is true: Await waits for what it says. 0: it is not asked any more.
  void OnClaim(std::uint64_t number) EXCLUDES(mutex_);
  void Offer(EditStream& stream) EXCLUDES(mutex_);
  // Mapping's batch with the correction that was taken has come.
  void OnAbsorbed(std::uint64_t version) EXCLUDES(mutex_);

  // Any thread; see UplinkThread.
  std::optional<ReadyCorrection> Take() EXCLUDES(mutex_);
  bool Await(Time deadline) EXCLUDES(mutex_);
  // Whether the server found the newest claim true, or nobody waits for that.
  bool agrees() EXCLUDES(mutex_);
  void EndWaiting() EXCLUDES(mutex_);

 private:
  // The uplink thread's own.
  CorrectionAssembly assembly_;
  std::deque<std::shared_ptr<AgentCorrection>> waiting_;
  bool offered_ = false;  // and not yet absorbed

  Mutex mutex_;
  ConditionVariable changed_;
  std::optional<ReadyCorrection> ready_ GUARDED_BY(mutex_);
  std::uint64_t absorbed_version_ GUARDED_BY(mutex_) = 0;
  std::uint64_t newest_version_ GUARDED_BY(mutex_) = 0;  // the server has told of, in whatever way
  bool server_works_ GUARDED_BY(mutex_) = false;
  std::uint64_t claimed_ GUARDED_BY(mutex_) = 0;
  std::uint64_t agreed_claim_ GUARDED_BY(mutex_) = 0;
  bool hurried_ GUARDED_BY(mutex_) = false;
};

}  // namespace pangaea
