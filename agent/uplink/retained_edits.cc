#include "agent/uplink/retained_edits.h"

#include <algorithm>
#include <utility>

#include "common/base/check.h"

namespace pangaea {

Status RetainedEditsOptions::Check() const {
  if (memory_bytes > 0 && in_flight_bytes > 0 && first_timeout.count() > 0 && last_timeout >= first_timeout) return {};
  return Fail(ErrorCode::kInvalidArgument,
              "uplink: memory_bytes and in_flight_bytes must be > 0, and 0 < first_timeout <= last_timeout");
}

Status RetainedEdits::Retain(Envelope envelope) {
  PANGAEA_CHECK(envelope.sequence == next_sequence());
  Slot slot{envelope.sequence, envelope.edits.size(), std::nullopt};
  Status status;
  bool in_memory = spill_ == nullptr || memory_bytes_ + slot.bytes <= options_.memory_bytes;
  if (!in_memory) {
    status = spill_->Append(envelope);
    in_memory = !status;
  }
  if (in_memory) {
    memory_bytes_ += slot.bytes;
    slot.envelope = std::move(envelope);
  }
  last_ = slot.sequence;
  slots_.push_back(std::move(slot));
  return status;
}

Result<Envelope> RetainedEdits::Find(std::uint64_t sequence) {
  if (sequence <= acked_ || sequence > last_) return Fail(ErrorCode::kNotFound, "this envelope is not retained");
  const Slot& slot = SlotOf(sequence);
  if (slot.envelope) return *slot.envelope;
  return spill_->Read(sequence);
}

Status RetainedEdits::SpillAll() {
  PANGAEA_CHECK(spill_ != nullptr);
  for (Slot& slot : slots_) {
    if (!slot.envelope) continue;
    if (Status status = spill_->Append(*slot.envelope); !status) return status;
    slot.envelope.reset();
    memory_bytes_ -= slot.bytes;
  }
  return {};
}

Result<std::optional<Envelope>> RetainedEdits::NextToSend() {
  if (!server_present_ || sent_ == last_) return std::optional<Envelope>();
  const Slot& slot = SlotOf(sent_ + 1);
  // One envelope always fits, however large.
  if (in_flight_ > 0 && in_flight_ + slot.bytes > options_.in_flight_bytes) return std::optional<Envelope>();
  auto envelope = Find(slot.sequence);
  if (!envelope) return tl::make_unexpected(envelope.error());
  return std::optional<Envelope>(std::move(*envelope));
}

void RetainedEdits::OnSent(std::uint64_t sequence, Time now) {
  if (sequence != sent_ + 1 || sequence > last_) return;  // an ack or a restart came in between
  ++sent_;
  in_flight_ += SlotOf(sequence).bytes;
  if (!deadline_) deadline_ = now + timeout_;
}

std::vector<Rejection> RetainedEdits::OnAck(const EditAck& ack, Time now) {
  const bool other_server = incarnation_ != 0 && ack.server_incarnation != incarnation_;
  incarnation_ = ack.server_incarnation;
  std::vector<Rejection> fresh;
  // An ack beyond what was ever made belongs to nobody here.
  if (ack.up_to > last_) return fresh;
  if (ack.up_to > acked_) {
    for (; acked_ < ack.up_to; slots_.pop_front()) {
      const Slot& slot = slots_.front();
      acked_ = slot.sequence;
      if (slot.envelope) memory_bytes_ -= slot.bytes;
      if (acked_ <= sent_) in_flight_ -= slot.bytes;
    }
    sent_ = std::max(sent_, acked_);
    if (spill_ != nullptr) spill_->Discard(acked_);
    timeout_ = options_.first_timeout;
    deadline_ = in_flight_ > 0 ? std::optional(now + timeout_) : std::nullopt;
  }
  for (const Rejection& rejection : ack.rejections) {
    if (rejection.sequence <= reported_ || rejection.sequence > acked_) continue;
    reported_ = rejection.sequence;
    fresh.push_back(rejection);
  }
  if (other_server) GoBack();
  return fresh;
}

void RetainedEdits::OnServerPresent(bool present) {
  if (present == server_present_) return;
  server_present_ = present;
  timeout_ = options_.first_timeout;
  GoBack();
}

bool RetainedEdits::OnTime(Time now) {
  if (!deadline_ || now < *deadline_) return false;
  timeout_ = std::min(2 * timeout_, options_.last_timeout);
  GoBack();
  return true;
}

void RetainedEdits::GoBack() {
  if (sent_ > acked_) ++resends_;
  sent_ = acked_;
  in_flight_ = 0;
  deadline_.reset();
}

RetainedEdits::Slot& RetainedEdits::SlotOf(std::uint64_t sequence) { return slots_[sequence - acked_ - 1]; }

}  // namespace pangaea
