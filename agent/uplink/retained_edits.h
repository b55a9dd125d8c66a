#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "common/wire/edit_ack.h"
#include "common/wire/envelope.h"

namespace pangaea {

// Where retained envelopes go when memory is full. Sequences come in ascending order without gaps.
class SpillSink {
 public:
  virtual ~SpillSink() = default;
  virtual Status Append(const Envelope& envelope) = 0;
  virtual Result<Envelope> Read(std::uint64_t sequence) = 0;
  // Everything up to and including `sequence` may be forgotten.
  virtual void Discard(std::uint64_t sequence) = 0;
};

struct RetainedEditsOptions {
  std::size_t memory_bytes = 64U << 20U;    // beyond this the newest envelopes go to the spill sink
  std::size_t in_flight_bytes = 4U << 20U;  // sent and not acknowledged; half of what DDS blocks at
  // Without progress of the acks for this long, everything after the last ack is sent again; doubled each time.
  std::chrono::milliseconds first_timeout{1000};
  std::chrono::milliseconds last_timeout{16000};

  Status Check() const;
};

// The numbered envelopes the server has not acknowledged, and which of them to send next: go-back-N. Time is a value
// given by the caller, from any steady clock. Not thread-safe; owned by the uplink thread.
class RetainedEdits {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // `spill` may be null: then memory is not bounded. It outlives this object.
  RetainedEdits(const RetainedEditsOptions& options, SpillSink* spill)
      : options_(options), spill_(spill), timeout_(options.first_timeout) {}

  // The sequence the next retained envelope must have: 1, 2, 3 …
  std::uint64_t next_sequence() const { return last_ + 1; }
  // Takes the envelope in any case; an error says that the spill sink refused it and that it stays in memory.
  Status Retain(Envelope envelope);

  // One that is not acknowledged, from memory or the spill sink; kNotFound where there is none such.
  Result<Envelope> Find(std::uint64_t sequence);
  // The envelope to send next; none while the window is full, everything was sent, or there is no server. An error:
  // the spill sink lost it. Call OnSent when it went out.
  Result<std::optional<Envelope>> NextToSend();
  void OnSent(std::uint64_t sequence, Time now);

  // Takes the ack of any server, however late. Returns its rejections that are new, ascending: each is reported once.
  std::vector<Rejection> OnAck(const EditAck& ack, Time now);
  // A server came (back) or went. Nothing is sent while there is none; when one comes, all after the last ack.
  void OnServerPresent(bool present);
  // Goes back to the last ack if the deadline passed. Returns whether it did.
  bool OnTime(Time now);
  // When OnTime should be called next; none while nothing is in flight.
  std::optional<Time> deadline() const { return deadline_; }

  // Moves those not acknowledged from memory into the spill sink, of which there must be one: at the end.
  Status SpillAll();

  std::uint64_t acknowledged() const { return acked_; }
  std::uint64_t last_sequence() const { return last_; }
  bool all_acknowledged() const { return acked_ == last_; }
  std::uint64_t resends() const { return resends_; }  // how often it went back
  std::size_t memory_bytes() const { return memory_bytes_; }

 private:
  struct Slot {
    std::uint64_t sequence;
    std::size_t bytes;
    std::optional<Envelope> envelope;  // none: in the spill sink
  };

  void GoBack();
  Slot& SlotOf(std::uint64_t sequence);  // of a sequence not acknowledged

  RetainedEditsOptions options_;
  SpillSink* spill_;
  std::deque<Slot> slots_;  // acked_ + 1 … last_
  std::uint64_t acked_ = 0;
  std::uint64_t last_ = 0;
  std::uint64_t sent_ = 0;  // everything up to here was sent since the last going back
  std::uint64_t incarnation_ = 0;
  std::uint64_t reported_ = 0;  // rejections up to this sequence were reported
  std::uint64_t resends_ = 0;
  std::size_t in_flight_ = 0;
  std::size_t memory_bytes_ = 0;
  bool server_present_ = false;
  std::chrono::milliseconds timeout_;
  std::optional<Time> deadline_;
};

}  // namespace pangaea
