#include "common/base/bytes.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace pangaea {
namespace {

TEST(Bytes, WhatIsWrittenIsReadBack) {
  ByteWriter writer;
  writer.Word(std::uint16_t{0xabcd});
  writer.Word(-2.5);
  writer.Varint(std::numeric_limits<std::uint64_t>::max());
  writer.SignedVarint(std::numeric_limits<std::int64_t>::min());
  ByteReader reader(writer.bytes());
  EXPECT_EQ(reader.Word<std::uint16_t>(), 0xabcd);
  EXPECT_EQ(reader.Word<double>(), -2.5);
  EXPECT_EQ(reader.Varint(), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(reader.SignedVarint(), std::numeric_limits<std::int64_t>::min());
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(reader.remaining(), 0u);
}

TEST(Bytes, VarintsOfAllMagnitudesAreReadBack) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 10000; ++i) {
    const std::uint64_t value = random() >> (random() % 64);
    const auto signed_value = static_cast<std::int64_t>(random()) >> (random() % 64);
    ByteWriter writer;
    writer.Varint(value);
    writer.SignedVarint(signed_value);
    ByteReader reader(writer.bytes());
    ASSERT_EQ(reader.Varint(), value);
    ASSERT_EQ(reader.SignedVarint(), signed_value);
  }
}

TEST(Bytes, SmallMagnitudesOfEitherSignTakeOneByte) {
  ByteWriter writer;
  writer.SignedVarint(-64);
  writer.SignedVarint(63);
  EXPECT_EQ(writer.size(), 2u);
}

TEST(Bytes, ReadingBeyondTheEndFailsForGood) {
  ByteWriter writer;
  writer.Word(std::uint8_t{7});
  ByteReader reader(writer.bytes());
  EXPECT_EQ(reader.Word<std::uint32_t>(), 0u);
  EXPECT_FALSE(reader.ok());
  EXPECT_EQ(reader.Word<std::uint8_t>(), 0);
}

TEST(Bytes, AVarintOfMoreThan64BitsFails) {
  const std::vector<std::byte> endless(11, std::byte{0xff});
  ByteReader reader(endless);
  EXPECT_EQ(reader.Varint(), 0u);
  EXPECT_FALSE(reader.ok());
}

TEST(Bytes, ACountThatCannotFollowFails) {
  ByteWriter writer;
  writer.Varint(1000000);
  writer.Word(std::uint64_t{0});
  ByteReader reader(writer.bytes());
  EXPECT_EQ(reader.Count(1), 0u);
  EXPECT_FALSE(reader.ok());
}

TEST(Bytes, ACountOfWhatFollowsIsGiven) {
  ByteWriter writer;
  writer.Varint(2);
  writer.Word(std::uint64_t{0});
  ByteReader reader(writer.bytes());
  EXPECT_EQ(reader.Count(4), 2u);
  EXPECT_EQ(reader.Bytes(8).size(), 8u);
  EXPECT_TRUE(reader.ok());
  EXPECT_TRUE(reader.Bytes(1).empty());
  EXPECT_FALSE(reader.ok());
}

}  // namespace
}  // namespace pangaea
