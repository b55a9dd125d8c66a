#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "agent/uplink/edit_stream.h"
#include "agent/uplink/kept_keyframes.h"
#include "common/base/result.h"
#include "common/dds/participant.h"
#include "common/map/atlas.h"
#include "common/wire/agent_correction.h"
#include "common/wire/agent_state.h"
#include "common/wire/relocalization.h"
#include "common/wire/session_announcement.h"

namespace pangaea {

struct UplinkOptions {
  EditStreamOptions edits;
  KeptKeyframesOptions memory;
  std::size_t queue_batches = 64;  // mapping waits when the uplink is this far behind
  // Where envelopes go when memory is full, and what is left unsent at the end. Empty: pangaea-<session>.spill in the
  // current folder.
  std::filesystem::path spill_path;

  Status Check() const;
};

// What mapping did since its last batch.
struct UplinkBatch {
  std::shared_ptr<const Atlas> snapshot;  // after `applied_since`
  std::vector<MapEdit> applied_since;
  std::shared_ptr<const AgentCorrection> absorbed = nullptr;  // of TakeCorrection: the snapshot has absorbed it
  KeyframeId reference = {};                                  // what the camera is near to; none: not known
  std::vector<ForgottenKeyframe> forgotten = {};              // by the snapshot, after all the rest
};

// A correction of the server whose time has come, and what the server had of this session when it made it.
struct ReadyCorrection {
  std::shared_ptr<const AgentCorrection> correction;
  Atlas base;
};

struct UplinkCounters {
  std::uint64_t bytes_sent = 0;  // octets of edits, resent ones included
  std::uint64_t envelopes_sent = 0;
  std::uint64_t last_sequence = 0;
  std::uint64_t acknowledged = 0;
  std::uint64_t resends = 0;  // how often it went back to the last ack
  std::uint64_t rejections = 0;
  std::uint64_t corrections = 0;           // absorbed
  std::uint64_t complete_corrections = 0;  // of these, answers to a claim that was wrong
  std::uint64_t correction_version = 0;    // of the newest absorbed
  std::uint64_t bytes_received = 0;        // octets of corrections
  std::uint64_t forgotten = 0;             // keyframes, each time that one was
  std::uint64_t repairs = 0;               // how often it planned anew what was missing after rejections
  bool agreed = false;                     // the server found the newest claim true: both held the same then
  bool server_present = false;
  bool server_seen = false;  // at any time
  std::string last_error;    // empty: none
};

// The agent's line to the server: one thread that plans, numbers, retains and sends edits, and the only one that may
// block in a DDS write. Maps on without a server. Any thread may call it.
class UplinkThread {
 public:
  // Opens the topics and announces the session. `participant` outlives the uplink.
  static Result<std::unique_ptr<UplinkThread>> Start(const Participant& participant, SessionAnnouncement session,
                                                     UplinkOptions options);
  virtual ~UplinkThread() = default;

  // Waits only while `queue_batches` are waiting already. False after Stop.
  virtual bool Submit(UplinkBatch batch) = 0;

  // Sends everything in `batch` exactly and waits until the server acknowledged it; then asks it whether both hold the
  // same now (DigestClaim), for AwaitCorrection to wait for what it says. Returns the edits the agent applies
  // to its own atlas so that it equals the server's bit by bit on the digest's grid; usually none. kUnavailable when
  // the time is over first: what is not acknowledged is then in the spill file, which the message names. kRefused when
  // the server rejects something for good.
  virtual Result<std::vector<MapEdit>> Flush(UplinkBatch batch, std::chrono::milliseconds patience) = 0;

  // The next correction, to be absorbed by mapping and named in its next batch; the one after it is not ready before.
  virtual std::optional<ReadyCorrection> TakeCorrection() = 0;
  // Keyframes that the agent should forget now, because the server has them and they are far away: to be named in
  // mapping's next batch. Others are not chosen before.
  virtual std::vector<KeyframeId> TakeForgettable() = 0;
  // Waits until TakeCorrection has something (true), or until the server has told of everything it changed, works on
  // nothing that may change more and agrees with the last flush, or the time is over, or somebody hurries (false).
  virtual bool AwaitCorrection(std::chrono::milliseconds patience) = 0;
  // Asks the server where this frame was taken; requests are numbered by who asks. The answer is for TakeAnswer. The
  // place itself comes as a correction.
  virtual void AskWhere(std::uint64_t request, std::shared_ptr<const KeyframeData> frame) = 0;
  // The newest answer that was not taken yet; one that found the place before one that did not.
  virtual std::optional<RelocalizationAnswer> TakeAnswer() = 0;
  // Tells whoever looks how the agent does. Never waits.
  virtual void Tell(const AgentState& state) = 0;

  // No flush waits any longer, neither the present one nor a later one.
  virtual void Hurry() = 0;

  // Announces the orderly end and stops the thread. What was not acknowledged is left in the spill file. The destructor
  // does it too.
  virtual void Stop() = 0;

  virtual UplinkCounters counters() const = 0;

 protected:
  UplinkThread() = default;
};

}  // namespace pangaea
