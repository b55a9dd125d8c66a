#include "common/base/bytes.h"

#include <algorithm>

namespace pangaea {

void ByteWriter::Varint(std::uint64_t value) {
  while (value >= 0x80) {
    Word(static_cast<std::uint8_t>(value | 0x80));
    value >>= 7;
  }
  Word(static_cast<std::uint8_t>(value));
}

void ByteWriter::SignedVarint(std::int64_t value) {
  const auto bits = static_cast<std::uint64_t>(value);
  Varint((bits << 1) ^ static_cast<std::uint64_t>(value >> 63));
}

std::uint64_t ByteReader::Varint() {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    const auto byte = Word<std::uint8_t>();
    const auto bits = static_cast<std::uint64_t>(byte & 0x7f);
    // The tenth byte has room for one bit only.
    if (!ok_ || (shift == 63 && byte > 1)) break;
    value |= bits << shift;
    if (byte < 0x80) return value;
  }
  ok_ = false;
  return 0;
}

std::int64_t ByteReader::SignedVarint() {
  const std::uint64_t bits = Varint();
  return static_cast<std::int64_t>((bits >> 1) ^ (~(bits & 1) + 1));
}

std::span<const std::byte> ByteReader::Bytes(std::size_t count) {
  if (!Has(count)) return {};
  const auto view = bytes_.subspan(position_, count);
  position_ += count;
  return view;
}

std::size_t ByteReader::Count(std::size_t min_item_bytes) {
  const std::uint64_t count = Varint();
  ok_ = ok_ && count <= remaining() / std::max<std::size_t>(min_item_bytes, 1);
  return ok_ ? static_cast<std::size_t>(count) : 0;
}

}  // namespace pangaea
