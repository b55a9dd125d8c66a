#include "common/base/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace pangaea {
namespace {

using testing::ElementsAre;

TEST(Text, SecondsAreExactNanosecondsInEveryNotation) {
  EXPECT_EQ(ParseSeconds("1403715273.262142976"), 1403715273262142976);
  EXPECT_EQ(ParseSeconds("0"), 0);
  EXPECT_EQ(ParseSeconds("1.000000e-01"), 100000000);
  EXPECT_EQ(ParseSeconds("4.5E+1"), 45000000000);
  EXPECT_EQ(ParseSeconds("-0.5"), -500000000);
  EXPECT_EQ(ParseSeconds(".25"), 250000000);
  EXPECT_EQ(ParseSeconds("7."), 7000000000);
  EXPECT_EQ(ParseSeconds("1.2345678919"), 1234567891);
}

TEST(Text, WhatIsNotSecondsIsRefused) {
  for (const char* text : {"", "-", ".", "1.2.3", "1e", "nan", "inf", "0x10", "1 2", "99999999999999999999", "1e99"}) {
    EXPECT_EQ(ParseSeconds(text), std::nullopt) << text;
  }
}

TEST(Text, FormattedSecondsReadBackAsTheSameStamp) {
  using Limits = std::numeric_limits<std::int64_t>;
  for (const std::int64_t stamp : {std::int64_t{0}, std::int64_t{1}, std::int64_t{-1}, std::int64_t{999999999},
                                   std::int64_t{1403715273262142976}, Limits::max(), Limits::min() + 1}) {
    EXPECT_EQ(ParseSeconds(FormatSeconds(stamp)), stamp);
  }
  EXPECT_EQ(FormatSeconds(5), "0.000000005");
}

TEST(Text, LinesEndInAnyWayAndTheLastNeedsNoEnding) {
  std::vector<std::string> lines;
  ForEachLine("a\r\n\n b \nc", [&](int number, std::string_view line) {
    lines.push_back(std::to_string(number) + ":" + std::string(line));
  });
  EXPECT_THAT(lines, ElementsAre("1:a", "2:", "3:b", "4:c"));
}

TEST(Text, FieldsLoseTheirOuterBlanks) {
  EXPECT_THAT(SplitFields("1, two ,,3 ", ','), ElementsAre("1", "two", "", "3"));
  EXPECT_THAT(SplitFields("  1 \t 2  3 ", ' '), ElementsAre("1", "2", "3"));
}

TEST(Text, NumbersAreWholeAndFinite) {
  EXPECT_EQ(ParseNumber("-1.5e3"), -1500.0);
  EXPECT_EQ(ParseNumber("1.5x"), std::nullopt);
  EXPECT_EQ(ParseNumber("nan"), std::nullopt);
  EXPECT_EQ(ParseInteger("12"), 12);
  EXPECT_EQ(ParseInteger("12.0"), std::nullopt);
}

TEST(Text, AMissingFileIsNamed) {
  const auto text = ReadTextFile("/does/not/exist.csv");
  ASSERT_FALSE(text);
  EXPECT_THAT(text.error().message, testing::HasSubstr("/does/not/exist.csv"));
}

}  // namespace
}  // namespace pangaea
