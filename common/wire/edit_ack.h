#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/map/ids.h"

namespace pangaea {

// Why an envelope was refused as a whole. On the wire an integer: other values may come from newer servers.
enum class RejectionReason : std::uint32_t {
  kUnspecified = 0,
  kUnknownWireVersion = 1,  // a wire version the server does not know
  kChecksum = 2,            // the octets are not those the checksum was made of
  kTooLarge = 3,            // larger than kMaxEnvelopeBytes
  kMalformed = 4,           // the octets do not decode
  kInvalid = 5,             // decoded, but an edit has impossible numbers or does not fit the atlas
  kUnknownReference = 6,    // an edit refers to a keyframe or landmark the server does not have
  kForeignSession = 7,      // the sender does not own the ids it uses
};

struct Rejection {
  std::uint64_t sequence = 0;
  RejectionReason reason = RejectionReason::kUnspecified;
  std::string text;  // for people
  bool operator==(const Rejection&) const = default;
};

// Cumulative: everything up to and including `up_to` is durable at the server, or was rejected.
struct EditAck {
  SessionId session = 0;
  std::uint64_t up_to = 0;
  std::uint64_t server_incarnation = 0;  // another number: another run of the server. Never 0.
  std::vector<Rejection> rejections;     // of sequences since the previous ack; may repeat
  // The newest correction there is for the session: sent, or about to be. 0 before any.
  std::uint64_t correction_version = 0;
  // The server is still at work on something that may correct the session. When that ends it acknowledges once more.
  bool working = false;
  // The newest claim of the session (MapInterest) that was found true; 0 before any.
  std::uint64_t agreed_claim = 0;
  bool operator==(const EditAck&) const = default;
};

}  // namespace pangaea
