#include "common/wire/envelope.h"

#include <string>

#include "common/base/hash.h"
#include "common/map/map_edit.h"

namespace pangaea {

Envelope MakeEnvelope(SessionId session, std::uint64_t sequence, std::uint64_t base_correction_version,
                      std::span<const MapEdit> edits) {
  Envelope envelope;
  envelope.session = session;
  envelope.sequence = sequence;
  envelope.base_correction_version = base_correction_version;
  envelope.wire_version = kWireVersion;
  envelope.edits = EncodeEdits(edits);
  envelope.checksum = Hash64(envelope.edits);
  return envelope;
}

Status CheckEnvelope(const Envelope& envelope) {
  if (envelope.session == 0) return Fail(ErrorCode::kInvalidArgument, "an envelope of session 0");
  if (envelope.sequence == 0) return Fail(ErrorCode::kInvalidArgument, "an envelope of sequence 0");
  if (envelope.wire_version < kOldestWireVersion || envelope.wire_version > kWireVersion) {
    return Fail(ErrorCode::kUnsupported, "wire version " + std::to_string(envelope.wire_version) + "; known are " +
                                             std::to_string(kOldestWireVersion) + " to " +
                                             std::to_string(kWireVersion));
  }
  if (envelope.edits.size() > kMaxEnvelopeBytes) {
    return Fail(ErrorCode::kInvalidArgument, "an envelope of " + std::to_string(envelope.edits.size()) +
                                                 " octets; the limit is " + std::to_string(kMaxEnvelopeBytes));
  }
  if (Hash64(envelope.edits) != envelope.checksum) {
    return Fail(ErrorCode::kCorrupt, "the checksum of envelope " + std::to_string(envelope.sequence) + " is wrong");
  }
  return {};
}

}  // namespace pangaea
