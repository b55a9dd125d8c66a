#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace pangaea {

// XXH3 64-bit: for checksums against accidents and for digests, not against an attacker.
std::uint64_t Hash64(std::span<const std::byte> bytes);

}  // namespace pangaea
