#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "cli/status.h"
#include "cli/undo.h"
#include "server/storage/recovery.h"
#include "tests/map/small_world.h"
#include "tests/server/flight.h"
#include "tests/server/server_process.h"
#include "tests/server/temporary_store.h"

namespace pangaea {
namespace {

using ::testing::HasSubstr;

struct CommandRun {
  int exit_code;
  std::string out;
  std::string err;
};

CommandRun RunPangaea(std::vector<const char*> words) {
  words.insert(words.begin(), "pangaea");
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  const int code = RunCommandLine({UndoCommand(), StatusCommand()}, static_cast<int>(words.size()), words.data());
  std::string out = ::testing::internal::GetCapturedStdout();
  return {code, std::move(out), ::testing::internal::GetCapturedStderr()};
}

// Two flights that a server merged, in a store; the merge is "merge 7".
void WriteMergedStore(const TemporaryStore& place) {
  Store store = Store::Open(place.path(), "hall", {}).value();
  Flight anna(kAnna);
  Flight bert(kBert, {.keypoints = 41});
  JournalBatch batch;
  for (std::uint64_t i = 1; i <= 3; ++i) batch.entries.push_back({i, anna.Next()});
  for (std::uint64_t i = 4; i <= 6; ++i) batch.entries.push_back({i, bert.Next()});
  const std::vector<MapEdit> merge{MergeMaps{M(1), M(1, kBert), {}, K(1, kBert), K(1), 7}};
  batch.server_edits.push_back({7, "merge 7", EncodeEdits(merge)});
  batch.sessions = {{anna.Announcement("hall"), 1, 3, 0}, {bert.Announcement("hall"), 2, 3, 0}};
  ASSERT_TRUE(store.Append(batch));
}

std::size_t MapsIn(const TemporaryStore& place) {
  Store store = Store::OpenReadOnly(place.path()).value();
  return RecoverAtlas(store).value().atlas.Maps().size();
}

// With the work that a server does by itself, which has to come to rest for it.
class UndoAtAServer : public ::testing::Test {
 protected:
  UndoAtAServer() {
    UseOwnDiscoveryTag();
    WriteMergedStore(place_);
  }
  std::unique_ptr<ServerProcess> StartServer() const {
    return std::make_unique<ServerProcess>(
        std::vector<std::string>{"--site", "hall", "--store", place_.path().string(), "--log-level", "off"});
  }

  TemporaryStore place_;
};

TEST_F(UndoAtAServer, ARunningServerTakesAMergeBackAndSaysSo) {
  const auto server = StartServer();
  EXPECT_EQ(MapsIn(place_), 1u);
  const CommandRun run = RunPangaea({"undo", "merge", "7", "--site", "hall"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("merge 7 is undone"));
  EXPECT_THAT(run.out, HasSubstr("will not be merged again"));
  EXPECT_EQ(MapsIn(place_), 2u);
  // It goes on with the atlas as it is now: what it shows, and what it leaves behind.
  const CommandRun status = RunPangaea({"status", "--site", "hall", "--json", "--until-idle", "60"});
  EXPECT_THAT(status.out, HasSubstr("\"id\":\"000000000000000a/1\""));
  EXPECT_THAT(status.out, HasSubstr("\"id\":\"000000000000000b/1\""));
  server->Signal(SIGTERM);
  EXPECT_EQ(server->Wait(), 0);
  EXPECT_EQ(MapsIn(place_), 2u);
}

TEST_F(UndoAtAServer, WhatCannotBeUndoneIsAClearErrorAndTheServerGoesOn) {
  const auto server = StartServer();
  CommandRun run = RunPangaea({"undo", "merge", "5", "--site", "hall"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("the journal has no 'merge 5'"));
  EXPECT_EQ(RunPangaea({"undo", "merge", "7", "--site", "hall"}).exit_code, 0);
  run = RunPangaea({"undo", "merge", "7", "--site", "hall"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("merge 7 was undone already"));
  server->Signal(SIGTERM);
  EXPECT_EQ(server->Wait(), 0);
}

TEST_F(UndoAtAServer, WithoutAServerItSaysThatNoneIsThere) {
  const CommandRun run = RunPangaea({"undo", "merge", "7", "--site", "hall", "--timeout", "0.2"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("no server of site 'hall'"));
  EXPECT_EQ(MapsIn(place_), 1u);
}

TEST_F(UndoAtAServer, AStoreThatAServerHasOpenIsRefused) {
  const auto server = StartServer();
  EXPECT_EQ(RunPangaea({"status", "--site", "hall", "--timeout", "60"}).exit_code, 0);
  const std::string path = place_.path().string();
  const CommandRun run = RunPangaea({"undo", "merge", "7", "--store", path.c_str()});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("in use by another process"));
}

TEST(PangaeaUndo, WrongOptionsAreUsageErrors) {
  EXPECT_EQ(RunPangaea({"undo", "merge", "7"}).exit_code, 2);
  EXPECT_EQ(RunPangaea({"undo", "merge", "7", "--site", "a", "--store", "b"}).exit_code, 2);
  EXPECT_EQ(RunPangaea({"undo", "--site", "a", "--list"}).exit_code, 2);
  EXPECT_EQ(RunPangaea({"undo", "--site", "a"}).exit_code, 2);
}

}  // namespace
}  // namespace pangaea
