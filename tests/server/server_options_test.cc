#include "server/runtime/server_options.h"

#include <gtest/gtest.h>

#include <fstream>

#include "server/runtime/atlas_work.h"
#include "tests/server/temporary_store.h"

namespace pangaea {
namespace {

Status LoadText(const std::string& text, ServerOptions& options) {
  const TemporaryStore place;
  const auto file = place.path().parent_path() / "server.yaml";
  std::ofstream(file) << text;
  return LoadServerOptions(file, options);
}

TEST(ServerOptions, TheShippedFileHoldsTheDefaults) {
  ServerOptions shipped;
  // Other values than the defaults: what the file does not set would stay.
  shipped.site = "elsewhere";
  shipped.service.queue_capacity = 1;
  shipped.service.snapshot_bytes = 1;
  shipped.status.longest_interval = std::chrono::milliseconds(1);
  const Status status = LoadServerOptions(PANGAEA_SOURCE_DIR "/config/server.yaml", shipped);
  ASSERT_TRUE(status) << status.error().message;
  const ServerOptions defaults;
  EXPECT_TRUE(shipped.Check());
  EXPECT_EQ(shipped.site, defaults.site);
  EXPECT_EQ(shipped.store, defaults.store);
  EXPECT_EQ(shipped.log_level, defaults.log_level);
  EXPECT_EQ(shipped.domain.id, defaults.domain.id);
  EXPECT_EQ(shipped.service.queue_capacity, defaults.service.queue_capacity);
  EXPECT_EQ(shipped.service.round_envelopes, defaults.service.round_envelopes);
  EXPECT_EQ(shipped.service.round_bytes, defaults.service.round_bytes);
  EXPECT_EQ(shipped.service.ingest.max_sessions, defaults.service.ingest.max_sessions);
  EXPECT_EQ(shipped.service.store.max_bytes, defaults.service.store.max_bytes);
  EXPECT_EQ(shipped.service.snapshot_envelopes, defaults.service.snapshot_envelopes);
  EXPECT_EQ(shipped.service.snapshot_bytes, defaults.service.snapshot_bytes);
  EXPECT_EQ(shipped.status.longest_interval, defaults.status.longest_interval);
  EXPECT_EQ(shipped.status.shortest_interval, defaults.status.shortest_interval);
}

TEST(ServerOptions, TheShippedFileHoldsTheDefaultsOfWhatTheServerDoesByItself) {
  ServerOptions shipped;
  WorkOptions& work = shipped.work;
  work.enabled = false;
  work.lookup.recent = 1;
  work.place.candidates.places = 1;
  work.place.geometry.min_inliers = 10;
  work.place.agreement.keyframes = 1;
  work.agenda.capacity = 1;
  work.fusion.window.keyframes = 2;
  work.fusion.judgement.min_common_landmarks = 10;
  work.fusion.judgement.max_cost_growth = 99;
  work.optimization = {.growth = 9.0, .patience = 99};
  work.map.bundle.max_seconds = 1;
  work.map.bundle.threads = 9;
  work.max_bytes = 1;
  work.redundancy.redundant_share = 0.2;
  work.redundancy.other_observers = 9;
  shipped.guests = {.wanted = 9, .new_at_once = 9};
  shipped.service.retention = {9, 9};
  ASSERT_TRUE(LoadServerOptions(PANGAEA_SOURCE_DIR "/config/server.yaml", shipped));
  const WorkOptions defaults;
  EXPECT_TRUE(work.enabled);
  EXPECT_EQ(work.vocabulary, defaults.vocabulary);
  EXPECT_EQ(work.lookup.recent, defaults.lookup.recent);
  EXPECT_EQ(work.place.candidates.places, defaults.place.candidates.places);
  EXPECT_EQ(work.place.geometry.min_inliers, defaults.place.geometry.min_inliers);
  EXPECT_EQ(work.place.agreement.keyframes, defaults.place.agreement.keyframes);
  EXPECT_EQ(work.agenda.capacity, defaults.agenda.capacity);
  EXPECT_EQ(work.fusion.window.keyframes, defaults.fusion.window.keyframes);
  EXPECT_EQ(work.fusion.judgement.min_common_landmarks, defaults.fusion.judgement.min_common_landmarks);
  EXPECT_EQ(work.fusion.judgement.max_cost_growth, defaults.fusion.judgement.max_cost_growth);
  EXPECT_EQ(work.optimization.growth, defaults.optimization.growth);
  EXPECT_EQ(work.optimization.patience, defaults.optimization.patience);
  EXPECT_EQ(work.map.bundle.max_seconds, defaults.map.bundle.max_seconds);
  EXPECT_EQ(work.map.bundle.threads, defaults.map.bundle.threads);
  EXPECT_EQ(work.max_bytes, defaults.max_bytes);
  EXPECT_EQ(work.redundancy.redundant_share, defaults.redundancy.redundant_share);
  EXPECT_EQ(work.redundancy.other_observers, defaults.redundancy.other_observers);
  EXPECT_EQ(shipped.guests.wanted, GuestOptions().wanted);
  EXPECT_EQ(shipped.guests.new_at_once, GuestOptions().new_at_once);
  EXPECT_EQ(shipped.service.retention.snapshots, SnapshotRetention().snapshots);
  EXPECT_EQ(shipped.service.retention.journal_bytes, SnapshotRetention().journal_bytes);
}

TEST(ServerOptions, AVocabularyThatIsNotThereIsAnErrorThatNamesFileAndKey) {
  ServerOptions options;
  const TemporaryStore place;
  options.work.vocabulary = "no/such.bin";
  const auto service = AtlasService::Open(place.path(), "hall", {});
  ASSERT_TRUE(service);
  const auto work = AtlasWork::Create(**service, options.work, {[](const AtlasEvent&) {}, [] {}});
  ASSERT_FALSE(work);
  EXPECT_NE(work.error().message.find("recognition.vocabulary"), std::string::npos) << work.error().message;
  EXPECT_NE(work.error().message.find("no/such.bin"), std::string::npos) << work.error().message;
}

TEST(ServerOptions, UnknownKeyIsAnErrorThatNamesIt) {
  ServerOptions options;
  const Status status = LoadText("site: hall\nstorre:\n  path: a.db\n", options);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("storre"), std::string::npos) << status.error().message;
}

TEST(ServerOptions, ValueOutOfRangeIsAnErrorThatNamesTheKey) {
  ServerOptions options;
  const Status status = LoadText("ingest:\n  queue_capacity: 0\n", options);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("queue_capacity"), std::string::npos) << status.error().message;
}

TEST(ServerOptions, SizesAreRead) {
  ServerOptions options;
  ASSERT_TRUE(LoadText("store:\n  path: b.db\n  max_mib: 3\nsnapshot:\n  every_mib: 5\n", options));
  EXPECT_EQ(options.store, "b.db");
  EXPECT_EQ(options.service.store.max_bytes, 3U << 20);
  EXPECT_EQ(options.service.snapshot_bytes, 5U << 20);
}

TEST(ServerOptions, BadSiteAndLogLevelAreRefused) {
  ServerOptions options;
  options.site = "no spaces";
  EXPECT_FALSE(options.Check());
  options.site = "hall";
  EXPECT_TRUE(options.Check());
  options.log_level = "loud";
  EXPECT_FALSE(options.Check());
}

}  // namespace
}  // namespace pangaea
