#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace pangaea {

static_assert(std::endian::native == std::endian::little, "the byte codec writes little-endian words as they are");

// Appends values to a byte string: fixed-size words little-endian, counts as LEB128 varints.
class ByteWriter {
 public:
  template <typename T>
  requires std::is_arithmetic_v<T>
  void Word(T value) {
    const std::size_t begin = bytes_.size();
    bytes_.resize(begin + sizeof(T));
    std::memcpy(bytes_.data() + begin, &value, sizeof(T));
  }
  void Varint(std::uint64_t value);
  // Zigzag: small magnitudes of either sign are short.
  void SignedVarint(std::int64_t value);
  void Bytes(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

  std::size_t size() const { return bytes_.size(); }
  std::span<const std::byte> bytes() const { return bytes_; }
  std::vector<std::byte> Take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

// Reads what a ByteWriter wrote, from bytes that may be anything. After the first read beyond the end, or the first
// malformed varint, ok() is false for good and every further read gives zero: callers check once, at the end.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename T>
  requires std::is_arithmetic_v<T> T Word() {
    T value{};
    if (!Has(sizeof(T))) return value;
    std::memcpy(&value, bytes_.data() + position_, sizeof(T));
    position_ += sizeof(T);
    return value;
  }
  std::uint64_t Varint();
  std::int64_t SignedVarint();
  // A view into the bytes given at construction; empty when there are fewer left.
  std::span<const std::byte> Bytes(std::size_t count);
  // A varint count of items of at least `min_item_bytes` bytes each. Fails when that many cannot follow, so that a
  // hostile count never makes the reader of it allocate more than the message could hold.
  std::size_t Count(std::size_t min_item_bytes);
  void Invalidate() { ok_ = false; }

  bool ok() const { return ok_; }
  std::size_t remaining() const { return bytes_.size() - position_; }

 private:
  bool Has(std::size_t count) {
    ok_ = ok_ && remaining() >= count;
    return ok_;
  }

  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

}  // namespace pangaea
