#pragma once

#include <cstddef>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace pangaea {

// Octets of a message of one of lcm-gen's types.
template <typename Message>
std::vector<std::byte> EncodeMessage(const Message& message) {
  std::vector<std::byte> payload(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(payload.data(), 0, static_cast<int>(payload.size()));
  return payload;
}

// The message that exactly these octets are. For types without arrays whose length is in the message: lcm-gen's code
// believes such a length.
template <typename Message>
Result<Message> DecodeMessage(std::span<const std::byte> payload) {
  Message message{};
  const int size = static_cast<int>(payload.size());
  if (message.decode(payload.data(), 0, size) == size) return message;
  return Fail(ErrorCode::kCorrupt,
              std::string("not a whole ") + Message::getTypeName() + ": " + std::to_string(size) + " octets");
}

}  // namespace pangaea
