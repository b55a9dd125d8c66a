#include "common/base/hash.h"

#include <xxhash.h>

namespace pangaea {

std::uint64_t Hash64(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

}  // namespace pangaea
