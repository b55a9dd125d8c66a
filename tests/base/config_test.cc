#include "common/base/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pangaea {
namespace {

using testing::HasSubstr;
using testing::Not;

ConfigReader Parse(const std::string& text) {
  auto reader = ConfigReader::Parse(text, "agent.yaml");
  EXPECT_TRUE(reader) << reader.error().message;
  return std::move(*reader);
}

// What reading the one known key, tracking.max_landmarks from 1 to 5000, says about a text.
std::string MessageFor(const std::string& text) {
  ConfigReader reader = Parse(text);
  int value = 7;
  reader.Read("tracking.max_landmarks", &value, Range{1, 5000});
  const Status status = reader.Finish();
  return status ? "" : status.error().message;
}

TEST(ConfigReader, ValuesOfEveryKindReachTheOptions) {
  ConfigReader reader = Parse("count: 12\nlength: 1.5e-3\non: true\nname: hall\nrate: max\nlist: [1, 2, -3.5]\n");
  std::size_t count = 0;
  float length = 0.0F;
  bool on = false;
  std::string name;
  std::size_t rate = 0;
  std::vector<double> list;
  reader.Read("count", &count, Range{1, 20});
  reader.Read("length", &length, Range{0.0, 1.0});
  reader.Read("on", &on);
  reader.Read("name", &name);
  reader.ReadChoice("rate", &rate, {"realtime", "max"});
  reader.RequireList("list", &list, {3}, Range{-10.0, 10.0});
  ASSERT_TRUE(reader.Finish()) << reader.Finish().error().message;
  EXPECT_EQ(count, 12U);
  EXPECT_FLOAT_EQ(length, 1.5e-3F);
  EXPECT_TRUE(on);
  EXPECT_EQ(name, "hall");
  EXPECT_EQ(rate, 1U);
  EXPECT_THAT(list, testing::ElementsAre(1.0, 2.0, -3.5));
}

TEST(ConfigReader, AnEmptyFileKeepsTheDefaults) {
  ConfigReader reader = Parse("# nothing here\n");
  int value = 7;
  reader.Read("tracking.max_landmarks", &value, Range{1, 5000});
  EXPECT_TRUE(reader.Finish());
  EXPECT_EQ(value, 7);
}

TEST(ConfigReader, AnUnknownKeyIsNamedWithItsLineAndTheNearestKnownOne) {
  const std::string message = MessageFor("# comment\ntracking:\n  max_landmark: 30\n");
  EXPECT_THAT(message, HasSubstr("agent.yaml:3:"));
  EXPECT_THAT(message, HasSubstr("unknown key tracking.max_landmark;"));
  EXPECT_THAT(message, HasSubstr("nearest known key is tracking.max_landmarks"));
}

TEST(ConfigReader, AnUnknownSectionIsReportedOnce) {
  const std::string message = MessageFor("traking:\n  max_landmarks: 30\n  other: 4\n");
  EXPECT_THAT(message, HasSubstr("agent.yaml:1: unknown key traking;"));
  EXPECT_THAT(message, Not(HasSubstr("\n")));
}

TEST(ConfigReader, AMissingFileIsNamed) {
  const auto reader = ConfigReader::Open("/does/not/exist.yaml");
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(reader.error().message, HasSubstr("/does/not/exist.yaml"));
}

TEST(ConfigReader, AValueOutOfRangeIsRefusedWithTheRangeAndLeavesTheOption) {
  ConfigReader reader = Parse("tracking: {max_landmarks: 9000}\n");
  int value = 7;
  reader.Read("tracking.max_landmarks", &value, Range{1, 5000});
  const Status status = reader.Finish();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(status.error().message, "agent.yaml:1: tracking.max_landmarks is '9000'; allowed: 1 to 5000");
  EXPECT_EQ(value, 7);
}

TEST(ConfigReader, AWrongTypeIsRefused) {
  EXPECT_THAT(MessageFor("tracking: {max_landmarks: many}\n"), HasSubstr("not a whole number"));
  EXPECT_THAT(MessageFor("tracking: {max_landmarks: 2.5}\n"), HasSubstr("not a whole number"));
  EXPECT_THAT(MessageFor("tracking: {max_landmarks: [1, 2]}\n"), HasSubstr("not a single value"));
  EXPECT_THAT(MessageFor("tracking: {max_landmarks: {a: 2}}\n"), HasSubstr("not a single value"));
  EXPECT_THAT(MessageFor("tracking: {max_landmarks: }\n"), HasSubstr("tracking.max_landmarks"));
  EXPECT_THAT(MessageFor("tracking: {max_landmarks: 99999999999999999999}\n"), HasSubstr("1 to 5000"));
}

TEST(ConfigReader, ADuplicateKeyIsRefusedWithBothLines) {
  const std::string message = MessageFor("tracking:\n  max_landmarks: 30\n  max_landmarks: 40\n");
  EXPECT_THAT(message, HasSubstr("agent.yaml:3:"));
  EXPECT_THAT(message, HasSubstr("second time"));
  EXPECT_THAT(message, HasSubstr("line 2"));
}

TEST(ConfigReader, NonFiniteNumbersAreNeverWithinARange) {
  for (const std::string text : {"nan", "inf", "-inf", ".nan", ".inf", "1e999"}) {
    ConfigReader reader = Parse("sigma: " + text + "\n");
    double sigma = 1.0;
    reader.Read("sigma", &sigma, Range{-std::numeric_limits<double>::infinity(), 1e308});
    EXPECT_FALSE(reader.Finish()) << text;
    EXPECT_EQ(sigma, 1.0) << text;
  }
}

TEST(ConfigReader, ANegativeNumberDoesNotWrapIntoAnUnsignedOption) {
  ConfigReader reader = Parse("count: -1\n");
  std::uint8_t count = 3;
  reader.Read("count", &count, Range{-5, 1000});
  ASSERT_FALSE(reader.Finish());
  EXPECT_THAT(reader.Finish().error().message, HasSubstr("0 to 255"));
  EXPECT_EQ(count, 3);
}

TEST(ConfigReader, ARequiredKeyThatIsMissingIsNamedWithWhatIsAllowed) {
  ConfigReader reader = Parse("other: 1\n");
  double rate = 0.0;
  std::vector<double> list;
  reader.Require("rate_hz", &rate, Range{0.1, 1000.0});
  reader.RequireList("intrinsics", &list, {4}, Range{0.0, 1e5});
  const Status status = reader.FinishIgnoringUnknown();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr("agent.yaml: the key rate_hz is missing; allowed: 0.1 to 1000"));
  EXPECT_THAT(status.error().message, HasSubstr("agent.yaml: the key intrinsics is missing; allowed: 4 numbers"));
}

TEST(ConfigReader, AListOfTheWrongLengthOrWithAWrongNumberIsRefused) {
  std::vector<double> list;
  ConfigReader reader = Parse("short: [1, 2]\nbad: [1, x, 3]\n");
  reader.RequireList("short", &list, {3, 4}, Range{0.0, 10.0});
  reader.RequireList("bad", &list, {3}, Range{0.0, 10.0});
  const std::string message = reader.Finish().error().message;
  EXPECT_THAT(message, HasSubstr("agent.yaml:1: short has 2 numbers; allowed: 3 or 4 numbers, each 0 to 10"));
  EXPECT_THAT(message, HasSubstr("agent.yaml:2: bad: number 2 is 'x'"));
  EXPECT_TRUE(list.empty());
}

TEST(ConfigReader, TextThatIsNotYamlIsAnErrorWithItsLine) {
  const auto broken = ConfigReader::Parse("a: 1\nb: [1, 2\n", "agent.yaml");
  ASSERT_FALSE(broken);
  EXPECT_THAT(broken.error().message, HasSubstr("agent.yaml:"));
  EXPECT_FALSE(ConfigReader::Parse("- just\n- a list\n", "agent.yaml"));
}

}  // namespace
}  // namespace pangaea
