#include "tests/place/shipped_vocabulary.h"

#include <gtest/gtest.h>

namespace pangaea {
namespace {

TEST(ShippedVocabulary, IsReadAndNoLargerThanFourMegabytes) {
  const auto bytes = ReadTextFile(testing::kShippedVocabulary);
  ASSERT_TRUE(bytes) << bytes.error().message;
  EXPECT_LE(bytes->size(), 4'000'000U);
  const auto tree = DecodeVocabulary(std::as_bytes(std::span(*bytes)));
  ASSERT_TRUE(tree) << tree.error().message;
  EXPECT_GE(tree->words(), 60'000U);
}

}  // namespace
}  // namespace pangaea
