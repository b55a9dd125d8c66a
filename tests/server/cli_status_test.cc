#include <gtest/gtest.h>

#include "cli/digest.h"
#include "cli/status.h"
#include "cli/status_table.h"
#include "server/runtime/status_json.h"
#include "server/storage/store.h"
#include "tests/map/small_world.h"
#include "tests/server/flight.h"
#include "tests/server/server_process.h"
#include "tests/server/temporary_store.h"

namespace pangaea {
namespace {

int RunPangaea(std::vector<const char*> words) {
  words.insert(words.begin(), "pangaea");
  return RunCommandLine({StatusCommand(), DigestCommand()}, static_cast<int>(words.size()), words.data());
}

TEST(PangaeaStatus, WithoutAServerItFailsWithAMessage) {
  UseOwnDiscoveryTag();
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(RunPangaea({"status", "--site", "nowhere", "--timeout", "0.1"}), 1);
  EXPECT_NE(::testing::internal::GetCapturedStderr().find("no server of site 'nowhere'"), std::string::npos);
}

TEST(PangaeaStatus, WrongOptionsAreUsageErrors) {
  EXPECT_EQ(RunPangaea({"status", "--timeout", "-1"}), 2);
  EXPECT_EQ(RunPangaea({"status", "--site", "no spaces", "--timeout", "0.1"}), 2);
}

TEST(PangaeaStatus, ShowsAServersStatusAsJson) {
  UseOwnDiscoveryTag();
  const TemporaryStore place;
  const ServerProcess server({"--site", "cli", "--store", place.path().string(), "--log-level", "off"});
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(RunPangaea({"status", "--site", "cli", "--json", "--timeout", "60"}), 0);
  const std::string text = ::testing::internal::GetCapturedStdout();
  for (const char* key : {"\"maps\"", "\"sessions\"", "\"store\"", "\"queues\"", "\"memory_mib\"", "\"versions\""}) {
    EXPECT_NE(text.find(key), std::string::npos) << key;
  }
}

TEST(StatusTable, ShowsWhatTheServerWrote) {
  Flight flight(kAnna);
  flight.Next();
  ServiceState state;
  state.ingest.atlas = flight.atlas();
  SessionRecord record;
  record.announcement = flight.Announcement("hall");
  record.acknowledged = 1;
  state.ingest.sessions.emplace(kAnna, IngestSession(record));
  state.store_error = "disk is full";
  DigestCache digests;
  ServerFacts facts;
  facts.site = "hall";
  const auto table = StatusTable({"hall", 1, 0, StatusJson(state, facts, digests)});
  ASSERT_TRUE(table) << table.error().message;
  for (const char* text : {"site hall", "1 keyframes", "disk is full", "agent-10", "gone", "000000000000000a/1"}) {
    EXPECT_NE(table->find(text), std::string::npos) << text << "\n" << *table;
  }
}

TEST(StatusTable, ShowsWhatWasMergedAndWhetherTheServerIsAtWork) {
  const AtlasStatus status{"hall", 1, 0, R"({"site": "hall", "under_way": true, "welds": {"merges": 2, "loops": 5,
      "refused": 1, "last": [{"evidence": "109 matches"}]}})"};
  const auto table = StatusTable(status);
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_NE(table->find("2 merges, 5 loops, 1 refused; at work"), std::string::npos) << *table;
  EXPECT_NE(table->find("last: 109 matches"), std::string::npos) << *table;
}

TEST(StatusTable, WorkIsUnderWayWhereTheStatusSaysSo) {
  EXPECT_TRUE(IsUnderWay({"hall", 1, 0, R"({"under_way": true})"}).value());
  EXPECT_FALSE(IsUnderWay({"hall", 1, 0, R"({"under_way": false})"}).value());
  EXPECT_FALSE(IsUnderWay({"hall", 1, 0, "{}"}).value());
  EXPECT_FALSE(IsUnderWay({"hall", 1, 0, R"({"under_way": 7})"}));
}

TEST(PangaeaStatus, WaitsUntilAServerIsIdle) {
  UseOwnDiscoveryTag();
  const TemporaryStore place;
  const ServerProcess server({"--site", "cli", "--store", place.path().string(), "--log-level", "off"});
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(RunPangaea({"status", "--site", "cli", "--json", "--timeout", "60", "--until-idle", "60"}), 0);
  EXPECT_NE(::testing::internal::GetCapturedStdout().find("\"under_way\":false"), std::string::npos);
}

TEST(StatusTable, AStatusThatIsNoJsonOrOfAnotherShapeIsAnError) {
  EXPECT_FALSE(StatusTable({"hall", 1, 0, "{"}));
  EXPECT_FALSE(StatusTable({"hall", 1, 0, R"({"site": 7})"}));
  EXPECT_FALSE(StatusTable({"hall", 1, 0, "[]"}));
}

TEST(PangaeaDigest, ReadsAStoreAndFailsClearlyWithoutOne) {
  const TemporaryStore place;
  const std::string path = place.path().string();
  EXPECT_EQ(RunPangaea({"digest", "--store", path.c_str()}), 1);
  EXPECT_EQ(RunPangaea({"digest"}), 2);
  { ASSERT_TRUE(Store::Open(place.path(), "hall", {})); }
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(RunPangaea({"digest", "--store", path.c_str(), "--json"}), 0);
  EXPECT_NE(::testing::internal::GetCapturedStdout().find("\"site\":\"hall\""), std::string::npos);
}

}  // namespace
}  // namespace pangaea
