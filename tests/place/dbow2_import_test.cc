#include "common/place/dbow2_import.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace pangaea {
namespace {

Descriptor Filled(std::uint8_t byte) {
  Descriptor descriptor;
  for (std::uint64_t& word : descriptor.words) word = 0x0101010101010101ULL * byte;
  return descriptor;
}

std::string Line(int parent, int is_word, int byte, const std::string& weight) {
  std::ostringstream line;
  line << parent << " " << is_word << " ";
  for (int i = 0; i < 32; ++i) line << byte << " ";
  line << weight << "\n";
  return line.str();
}

// Two groups; nodes in the order in which DBoW2 writes them, which is not breadth first.
const std::string kSmall = "2 2 0 0\n" + Line(0, 0, 0, "0") + Line(1, 1, 1, "1.5") + Line(1, 1, 2, "0.25") +
                           Line(0, 0, 255, "0") + Line(4, 1, 254, "3") + Line(4, 1, 127, "0");

TEST(Dbow2Import, WordsKeepTheirCentresAndWeights) {
  const auto tree = ImportDbow2(kSmall);
  ASSERT_TRUE(tree) << tree.error().message;
  EXPECT_EQ(tree->words(), 4U);
  EXPECT_EQ(tree->nodes(), 7U);
  EXPECT_EQ(tree->branching(), 2);
  EXPECT_EQ(tree->depth(), 2);
  const auto weight = [&](std::uint8_t byte) { return tree->WeightOf(tree->Word(Filled(byte))); };
  EXPECT_NEAR(weight(1), 1.5F, 1e-4F);
  EXPECT_NEAR(weight(2), 0.25F, 1e-4F);
  EXPECT_NEAR(weight(254), 3.0F, 1e-4F);
  EXPECT_EQ(weight(127), 0.0F);
}

TEST(Dbow2Import, BytesBecomeBitsInOrder) {
  std::string first_byte = "2 1 0 0\n0 1 8";
  for (int i = 1; i < 32; ++i) first_byte += " 0";
  const auto tree = ImportDbow2(first_byte + " 1.0 \r\n" + Line(0, 1, 255, "1"));
  ASSERT_TRUE(tree) << tree.error().message;
  EXPECT_EQ(tree->layout().centres[1], (Descriptor{{8, 0, 0, 0}}));
}

TEST(Dbow2Import, EveryDefectIsAnErrorThatNamesItsLine) {
  const std::string head = "2 2 0 0\n";
  const auto message = [](const std::string& text) {
    const auto tree = ImportDbow2(text);
    return tree ? std::string("accepted") : tree.error().message;
  };
  EXPECT_NE(message("2 2 0\n").find("line 1"), std::string::npos);
  EXPECT_NE(message("").find("vocabulary"), std::string::npos);
  EXPECT_NE(message(head + Line(5, 1, 1, "1")).find("line 2"), std::string::npos);
  EXPECT_NE(message(head + Line(0, 1, 1, "1") + Line(1, 1, 1, "1")).find("line 3"), std::string::npos);
  EXPECT_NE(message(head + Line(0, 1, 256, "1")).find("line 2"), std::string::npos);
  EXPECT_NE(message(head + Line(0, 1, 1, "nan")).find("line 2"), std::string::npos);
  EXPECT_NE(message(head + Line(0, 1, 1, "-1")).find("line 2"), std::string::npos);
  EXPECT_NE(message(head + Line(0, 1, 1, "1 7")).find("line 2"), std::string::npos);
  EXPECT_NE(message(head + "0 1 1 2 3\n").find("line 2"), std::string::npos);
  EXPECT_NE(message("200 2 0 0\n" + Line(0, 1, 1, "1")).find("branching"), std::string::npos);
}

TEST(Dbow2Import, NoTruncationBreaksIt) {
  for (std::size_t length = 0; length < kSmall.size(); ++length) {
    const auto tree = ImportDbow2(kSmall.substr(0, length));
    if (tree) {
      EXPECT_LT(tree->Word(Filled(3)), tree->words());
    }
  }
}

}  // namespace
}  // namespace pangaea
