#include "tests/place/shipped_vocabulary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/place/vocabulary_file.h"

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

TEST(ShippedVocabulary, IsBuiltIntoTheProgram) {
  const auto built_in = OpenVocabulary();
  ASSERT_TRUE(built_in) << built_in.error().message;
  const auto file = OpenVocabulary(testing::kShippedVocabulary);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ((*built_in)->fingerprint(), (*file)->fingerprint());
}

TEST(ShippedVocabulary, AFileThatIsMissingOrNoVocabularyIsNamed) {
  const auto missing = OpenVocabulary("no_such_vocabulary.bin");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, ::testing::HasSubstr("no_such_vocabulary.bin"));
  const auto other = OpenVocabulary(PANGAEA_SOURCE_DIR "/config/agent.yaml");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kCorrupt);
  EXPECT_THAT(other.error().message, ::testing::HasSubstr("agent.yaml"));
}

}  // namespace
}  // namespace pangaea
