#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "agent/runtime/agent_options.h"
#include "common/base/text.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

const std::filesystem::path kSource = PANGAEA_SOURCE_DIR;
const std::filesystem::path kShipped = kSource / "config/agent.yaml";

// What every key of the file sets.
std::map<std::string, double> ValuesOf(const AgentOptions& options) {
  const TrackingOptions& tracking = options.tracking;
  const LocalMappingOptions& mapping = options.mapping;
  const auto number = [](auto value) { return static_cast<double>(value); };
  return {
      {"tracking.min_inliers", number(tracking.min_inliers)},
      {"tracking.min_agreement", tracking.min_agreement},
      {"tracking.min_recovery_inliers", number(tracking.min_recovery_inliers)},
      {"tracking.min_start_points", number(tracking.min_start_points)},
      {"tracking.frames_for_hint", number(tracking.frames_for_hint)},
      {"tracking.frames_until_new_map", number(tracking.frames_until_new_map)},
      {"tracking.frames_for_hint", number(tracking.frames_for_hint)},
      {"tracking.max_position_sigma_m", tracking.observability.max_sigma_m},
      {"tracking.max_position_sigma_of_depth", tracking.observability.max_sigma_of_depth},
      {"tracking.max_templates", number(tracking.max_templates)},
      {"tracking.max_landmarks", number(tracking.search.max_landmarks)},
      {"tracking.patch_sigma", tracking.search.patch_sigma},
      {"tracking.local_keyframes", number(tracking.local_map.max_keyframes)},
      {"keyframes.min_coverage_ratio", tracking.keyframes.min_coverage_ratio},
      {"keyframes.min_inlier_ratio", tracking.keyframes.min_inlier_ratio},
      {"keyframes.max_relative_distance", tracking.keyframes.max_relative_distance},
      {"keyframes.max_turn", tracking.keyframes.max_turn},
      {"keyframes.min_gap", number(tracking.keyframes.min_gap)},
      {"monocular.min_parallax", tracking.monocular_start.two_view.min_parallax},
      {"monocular.min_points", number(tracking.monocular_start.two_view.min_points)},
      {"monocular.confirmations", number(tracking.monocular_start.confirmations)},
      {"monocular.min_coverage_ratio", tracking.monocular_keyframes.min_coverage_ratio},
      {"monocular.min_inlier_ratio", tracking.monocular_keyframes.min_inlier_ratio},
      {"monocular.max_relative_distance", tracking.monocular_keyframes.max_relative_distance},
      {"monocular.features", number(tracking.monocular_features)},
      {"features.count", number(tracking.orb.features)},
      {"features.high_threshold", number(tracking.orb.high_threshold)},
      {"features.low_threshold", number(tracking.orb.low_threshold)},
      {"mapping.window_keyframes", number(mapping.bundle_adjustment.window_keyframes)},
      {"mapping.fixed_keyframes", number(mapping.bundle_adjustment.fixed_keyframes)},
      {"mapping.iterations", number(mapping.bundle_adjustment.iterations)},
      {"mapping.max_strain", mapping.wide_adjustment.max_strain},
      {"mapping.wide_keyframes", number(mapping.wide_adjustment.bundle_adjustment.window_keyframes)},
      {"mapping.min_vergence_shift", mapping.vergence.min_shift},
      {"mapping.pixel_sigma", mapping.noise.pixel_sigma},
      {"mapping.max_depth_baselines", mapping.noise.max_depth_baselines},
      {"mapping.search_radius", mapping.search.radius},
      {"mapping.redundant_ratio", mapping.keyframe_culling.redundant_ratio},
      {"uplink.queue_batches", number(options.uplink.queue_batches)},
      {"uplink.envelope_bytes", number(options.uplink.edits.envelope_bytes)},
      {"memory.max_keyframes", number(options.uplink.memory.most)},
      {"memory.kept_keyframes", number(options.uplink.memory.left)},
      {"uplink.min_observations", number(options.uplink.edits.planner.min_observations)},
      {"uplink.patience_s", 0.001 * number(options.flush_patience.count())},
      {"memory.max_keyframes", number(options.uplink.memory.most)},
      {"memory.kept_keyframes", number(options.uplink.memory.left)},
      {"corrections.patience_s", 0.001 * number(options.correction_patience.count())},
      {"corrections.deterministic_frames", number(options.frames_between_corrections)},
  };
}

// The same of the keys whose values are names.
std::map<std::string, std::string> NamesOf(const AgentOptions& options) {
  const LcmChannels& lcm = options.lcm;
  return {{"lcm.images", lcm.images}, {"lcm.right_images", lcm.right_images},     {"lcm.calibration", lcm.calibration},
          {"lcm.pose", lcm.pose},     {"lcm.tracking_state", lcm.tracking_state}, {"lcm.statistics", lcm.statistics}};
}

template <typename Value>
std::set<std::string> KeysOf(const std::map<std::string, Value>& values) {
  std::set<std::string> keys;
  for (const auto& [key, value] : values) keys.insert(key);
  return keys;
}

// The keys and values that a person reads in the shipped file.
std::map<std::string, std::string> ShippedTexts() {
  std::map<std::string, std::string> texts;
  std::string section;
  std::smatch match;
  std::ifstream file(kShipped);
  for (std::string line; std::getline(file, line);) {
    if (std::regex_match(line, match, std::regex("(\\w+):"))) section = match[1];
    if (std::regex_match(line, match, std::regex("  (\\w+): (\\S+)"))) {
      texts[section + "." + match[1].str()] = match[2] == "\"\"" ? "" : match[2].str();
    }
  }
  return texts;
}

std::map<std::string, double> ShippedValues() {
  std::map<std::string, double> values;
  for (const auto& [key, text] : ShippedTexts()) {
    if (!NamesOf({}).contains(key)) values[key] = std::stod(text);
  }
  return values;
}

std::map<std::string, std::string> ShippedNames() {
  std::map<std::string, std::string> names = ShippedTexts();
  std::erase_if(names, [](const auto& entry) { return !NamesOf({}).contains(entry.first); });
  return names;
}

// The message for a file with one key of this value; empty where it was read.
std::string ReadOne(const std::string& key, const std::string& value, AgentOptions& options) {
  const testing::TemporaryFolder folder;
  const auto path = folder.path() / "agent.yaml";
  const std::size_t dot = key.find('.');
  std::ofstream(path) << key.substr(0, dot) << ":\n  " << key.substr(dot + 1) << ": " << value << "\n";
  const Status status = ReadAgentConfig(path, options);
  return status ? "" : status.error().message;
}

TEST(AgentOptions, TheShippedFileHoldsTheDefaults) {
  AgentOptions options;
  const Status status = ReadAgentConfig(kShipped, options);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(ValuesOf(options), ValuesOf({}));
  EXPECT_EQ(ShippedValues(), ValuesOf({}));
  EXPECT_EQ(NamesOf(options), NamesOf({}));
  EXPECT_EQ(ShippedNames(), NamesOf({}));
}

TEST(AgentOptions, EveryNameOfAChannelIsTakenFromTheFileAndOnesThatAreTooLongAreRefused) {
  for (const auto& [key, name] : NamesOf({})) {
    AgentOptions options;
    auto expected = NamesOf({});
    expected[key] = "ANOTHER";
    EXPECT_EQ(ReadOne(key, "ANOTHER", options), "");
    EXPECT_EQ(NamesOf(options), expected);
    EXPECT_NE(ReadOne(key, std::string(64, 'x'), options).find("allowed: 1 to 63 characters"), std::string::npos);
  }
}

TEST(AgentOptions, ExactlyOneInputMustBeGiven) {
  AgentOptions options;
  EXPECT_FALSE(options.CheckInput());
  options.dataset = "flight";
  EXPECT_TRUE(options.CheckInput());
  options.lcm_input = "file://flight.lcm";
  EXPECT_FALSE(options.CheckInput());
  options.dataset.clear();
  EXPECT_TRUE(options.CheckInput());
  options.lcm_output = "http://nowhere";
  EXPECT_FALSE(options.CheckInput());
}

TEST(AgentOptions, TheShippedFileDocumentsEveryKeyThatIsRead) {
  const auto source = ReadTextFile(kSource / "agent/runtime/agent_options.cc");
  ASSERT_TRUE(source);
  std::set<std::string> read;
  const std::regex call("Read\\w*\\((?:reader, )?\\s*\"([^\"]+)\"");
  for (std::sregex_iterator it(source->begin(), source->end(), call), end; it != end; ++it) read.insert((*it)[1]);
  EXPECT_EQ(KeysOf(ShippedTexts()), read);
}

TEST(AgentOptions, EveryKeySetsWhatItNamesAndNothingElse) {
  for (const auto& [key, value] : ValuesOf({})) {
    auto expected = ValuesOf({});
    expected[key] = value == std::round(value) ? value + 1.0 : value * 1.01;
    AgentOptions options;
    std::ostringstream text;
    text << expected[key];
    expected[key] = std::stod(text.str());  // as it is written
    EXPECT_EQ(ReadOne(key, text.str(), options), "");
    EXPECT_EQ(ValuesOf(options), expected) << key;
  }
}

TEST(AgentOptions, AValueOutOfRangeIsAnErrorWithFileLineKeyAndRange) {
  for (const auto& [key, value] : ValuesOf({})) {
    AgentOptions options;
    const std::string message = ReadOne(key, "-1", options);
    EXPECT_NE(message.find("agent.yaml:2: "), std::string::npos) << key << ": " << message;
    EXPECT_NE(message.find(key + " is '-1'"), std::string::npos) << key << ": " << message;
    EXPECT_TRUE(std::regex_search(message, std::regex("allowed: .*\\d.* to .*\\d"))) << key << ": " << message;
    EXPECT_EQ(ValuesOf(options), ValuesOf({})) << key;
  }
}

TEST(AgentOptions, AnUnknownKeyIsAnErrorThatNamesTheNearestKnownOne) {
  AgentOptions options;
  const std::string message = ReadOne("tracking.min_inlier", "20", options);
  EXPECT_NE(message.find("agent.yaml:2: "), std::string::npos) << message;
  EXPECT_NE(message.find("tracking.min_inliers"), std::string::npos) << message;
}

TEST(AgentOptions, AMissingFileIsAnErrorThatNamesIt) {
  AgentOptions options;
  const Status status = ReadAgentConfig("/nowhere/agent.yaml", options);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("/nowhere/agent.yaml"), std::string::npos);
}

TEST(AgentOptions, BadOptionsOfTheCommandLineAreRefusedBeforeTheRun) {
  const auto message = [](const std::function<void(AgentOptions&)>& spoil) {
    AgentOptions options;
    spoil(options);
    const Status status = options.Check();
    return status ? "" : status.error().message;
  };
  EXPECT_EQ(message([](AgentOptions&) {}), "");
  EXPECT_NE(message([](AgentOptions& o) { o.rate.speed = 1000.0; }).find("0.01 to 100"), std::string::npos);
  EXPECT_NE(message([](AgentOptions& o) { o.site = "no spaces"; }).find("no spaces"), std::string::npos);
  EXPECT_NE(message([](AgentOptions& o) { o.domain.id = 231; }).find("230"), std::string::npos);
  EXPECT_NE(message([](AgentOptions& o) { o.trajectory = "/no/such/a.tum"; }).find("/no/such"), std::string::npos);
  EXPECT_NE(message([](AgentOptions& o) { o.live_trajectory = "/no/such/a.tum"; }).find("/no/such"), std::string::npos);
  EXPECT_NE(message([](AgentOptions& o) { o.report = "/no/such/a.json"; }).find("/no/such"), std::string::npos);
}

}  // namespace
}  // namespace pangaea
