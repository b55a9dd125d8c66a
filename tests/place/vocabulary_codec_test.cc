#include "common/place/vocabulary_codec.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "common/base/hash.h"
#include "tests/place/synthetic_places.h"

namespace pangaea {
namespace {

using testing::Random;
using testing::SmallVocabulary;

// Makes the checksum fit again, so that what lies behind it is tested.
std::vector<std::byte> Sealed(std::vector<std::byte> bytes) {
  const std::size_t content = bytes.size() - sizeof(std::uint64_t);
  const std::uint64_t hash = Hash64(std::span(bytes).first(content));
  std::memcpy(bytes.data() + content, &hash, sizeof(hash));
  return bytes;
}

TEST(VocabularyCodec, DecodingGivesBackWhatWasEncoded) {
  for (const int depth : {1, 2, 4}) {
    const VocabularyTree tree = SmallVocabulary(3, 6, depth);
    const auto decoded = DecodeVocabulary(EncodeVocabulary(tree.layout()));
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(decoded->layout(), tree.layout());
    EXPECT_EQ(decoded->fingerprint(), tree.fingerprint());
  }
}

TEST(VocabularyCodec, AWordTakesItsCentreAndTwoBytes) {
  const VocabularyTree tree = SmallVocabulary();
  const std::size_t most = tree.nodes() * sizeof(Descriptor) + tree.words() * 2 + tree.nodes() - tree.words() + 64;
  EXPECT_LE(EncodeVocabulary(tree.layout()).size(), most + tree.words());
}

TEST(VocabularyCodec, EveryTruncationIsAnError) {
  const std::vector<std::byte> bytes = EncodeVocabulary(SmallVocabulary(1, 3, 2).layout());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_FALSE(DecodeVocabulary(std::span(bytes).first(length))) << length;
  }
}

TEST(VocabularyCodec, EveryFlippedByteIsAnError) {
  const std::vector<std::byte> bytes = EncodeVocabulary(SmallVocabulary(1, 3, 2).layout());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto damaged = bytes;
    damaged[i] ^= std::byte{0x10};
    EXPECT_FALSE(DecodeVocabulary(damaged)) << i;
  }
}

TEST(VocabularyCodec, HostileBytesWithARightChecksumNeverBreakTheTree) {
  const VocabularyTree tree = SmallVocabulary(1, 3, 3);
  const std::vector<std::byte> bytes = EncodeVocabulary(tree.layout());
  Random random(1);
  const Descriptor probe = testing::RandomDescriptor(random);
  int refused = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    auto hostile = bytes;
    // The head and the tree's shape lie in the first bytes.
    for (int change = 0; change < 2; ++change) hostile[random() % 40] = static_cast<std::byte>(random());
    if (random() % 4 == 0) hostile.resize(16 + random() % bytes.size());
    const auto decoded = DecodeVocabulary(Sealed(hostile));
    if (decoded) {
      EXPECT_LT(decoded->Word(probe), decoded->words());
    }
    refused += decoded ? 0 : 1;
  }
  EXPECT_GT(refused, 10000);
}

TEST(VocabularyCodec, ALaterVersionIsSaidToBeUnsupported) {
  auto bytes = EncodeVocabulary(SmallVocabulary(1, 3, 2).layout());
  bytes[4] = std::byte{9};
  EXPECT_EQ(DecodeVocabulary(Sealed(bytes)).error().code, ErrorCode::kUnsupported);
}

TEST(VocabularyLayout, WhatIsNoTreeIsRefused) {
  const VocabularyLayout good = SmallVocabulary(1, 3, 2).layout();
  const auto refused = [&](auto&& spoil) {
    VocabularyLayout layout = good;
    spoil(layout);
    return !VocabularyTree::Create(layout).has_value();
  };
  EXPECT_FALSE(refused([](VocabularyLayout&) {}));
  EXPECT_TRUE(refused([](VocabularyLayout& layout) { layout.child_counts[0] = 0; }));
  EXPECT_TRUE(refused([](VocabularyLayout& layout) { layout.child_counts[0] = 60; }));
  EXPECT_TRUE(refused([](VocabularyLayout& layout) { layout.child_counts.back() = 1; }));
  EXPECT_TRUE(refused([](VocabularyLayout& layout) { layout.centres.pop_back(); }));
  EXPECT_TRUE(refused([](VocabularyLayout& layout) { layout.word_weights.pop_back(); }));
  EXPECT_TRUE(refused([](VocabularyLayout& layout) { layout.depth = 1; }));
  EXPECT_TRUE(refused([](VocabularyLayout& layout) { layout.branching = 200; }));
  EXPECT_TRUE(refused([](VocabularyLayout& layout) { layout.weight_unit = std::numeric_limits<float>::quiet_NaN(); }));
  EXPECT_TRUE(refused([](VocabularyLayout& layout) { layout = VocabularyLayout{}; }));
}

}  // namespace
}  // namespace pangaea
