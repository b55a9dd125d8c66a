#include "agent/uplink/envelope_sender.h"

namespace pangaea {

Status EnvelopeSender::Send(RetainedEdits& retained) {
  if (pause_end_ && now_() < *pause_end_) return {};
  pause_end_.reset();
  while (true) {
    const auto envelope = retained.NextToSend();
    if (envelope && !envelope->has_value()) return {};
    const Status sent = envelope ? write_(**envelope) : tl::make_unexpected(envelope.error());
    const Time now = now_();
    if (!sent) {
      pause_end_ = now + kPause;
      return sent;
    }
    retained.OnSent((*envelope)->sequence, now);
    ++envelopes_;
    bytes_ += (*envelope)->edits.size();
  }
}

}  // namespace pangaea
