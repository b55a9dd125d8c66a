#include "server/storage/recovery.h"

#include <gtest/gtest.h>

#include "common/map/digest.h"
#include "server/storage/snapshot_store.h"
#include "tests/map/small_world.h"
#include "tests/server/flight.h"
#include "tests/server/temporary_store.h"

namespace pangaea {
namespace {

// A store with the first envelopes of a flight, one batch each.
class JournaledFlight {
 public:
  JournaledFlight() : store(Store::Open(place.path(), "hall", {}).value()) {}

  void Fly(int envelopes) {
    for (int i = 0; i < envelopes; ++i) ASSERT_TRUE(store.Append({{{++position, flight.Next()}}, {}, {}, {}}));
  }
  void Append(const std::vector<MapEdit>& edits) {
    ASSERT_TRUE(store.Append({{{++position, flight.NextWith(edits)}}, {}, {}, {}}));
  }
  Status Snapshot(const Atlas& atlas, std::stop_token stop = {}) {
    return SnapshotStore::Open(place.path(), 0, retention).value().Write(atlas, position, 1, stop);
  }
  Status Keep(const Atlas& atlas) {
    return SnapshotStore::Open(place.path(), 0, retention).value().Keep(atlas, position, 1, {});
  }
  std::int64_t Count(const char* table) {
    return store.database().Number((std::string("SELECT count(*) FROM ") + table).c_str()).value();
  }
  // The store as a server that starts after a crash finds it.
  RecoveredAtlas Recover() {
    auto reader = Store::OpenReadOnly(place.path()).value();
    auto recovered = RecoverAtlas(reader);
    EXPECT_TRUE(recovered) << recovered.error().message;
    return recovered ? *recovered : RecoveredAtlas();
  }

  TemporaryStore place;
  Store store;
  Flight flight{kAnna};
  std::uint64_t position = 0;
  SnapshotRetention retention;
};

TEST(Recovery, AnEmptyStoreGivesAnEmptyAtlas) {
  JournaledFlight journaled;
  const RecoveredAtlas recovered = journaled.Recover();
  EXPECT_EQ(recovered.atlas.keyframe_count(), 0u);
  EXPECT_EQ(recovered.position, 0u);
}

TEST(Recovery, TheJournalAloneGivesTheAtlasBitForBit) {
  JournaledFlight journaled;
  journaled.Fly(10);
  const RecoveredAtlas recovered = journaled.Recover();
  EXPECT_EQ(Fingerprint(recovered.atlas), Fingerprint(journaled.flight.atlas()));
  EXPECT_EQ(recovered.position, 10u);
  EXPECT_EQ(recovered.replayed, 10u);
}

TEST(Recovery, ASnapshotAndTheJournalAfterItGiveTheAtlasBitForBit) {
  JournaledFlight journaled;
  journaled.Fly(10);
  ASSERT_TRUE(journaled.Snapshot(journaled.flight.atlas()));
  journaled.Fly(5);
  const RecoveredAtlas recovered = journaled.Recover();
  EXPECT_EQ(Fingerprint(recovered.atlas), Fingerprint(journaled.flight.atlas()));
  EXPECT_EQ(recovered.snapshot_position, 10u);
  EXPECT_EQ(recovered.replayed, 5u);
}

TEST(Recovery, ASnapshotTruncatesTheJournalAndReplacesTheOlderOne) {
  JournaledFlight journaled;
  journaled.Fly(40);
  ASSERT_TRUE(journaled.Snapshot(journaled.flight.atlas()));
  journaled.Fly(3);
  ASSERT_TRUE(journaled.Snapshot(journaled.flight.atlas()));
  EXPECT_EQ(journaled.Count("envelopes"), 0);
  EXPECT_EQ(journaled.Count("snapshots"), 1);
  EXPECT_EQ(journaled.Count("(SELECT DISTINCT snapshot FROM snapshot_chunks)"), 1);
  EXPECT_EQ(journaled.Count("keyframe_payloads"), 43) << "each stored once";
}

TEST(Recovery, EntriesThatCameWhileTheSnapshotWasWrittenStayInTheJournal) {
  JournaledFlight journaled;
  journaled.Fly(10);
  const Atlas atlas = journaled.flight.atlas();
  SnapshotStore snapshots = SnapshotStore::Open(journaled.place.path(), 0).value();
  journaled.Fly(5);
  ASSERT_TRUE(snapshots.Write(atlas, 10, 1, {}));
  EXPECT_EQ(journaled.Count("envelopes"), 5);
  EXPECT_EQ(Fingerprint(journaled.Recover().atlas), Fingerprint(journaled.flight.atlas()));
}

TEST(Recovery, AnInterruptedSnapshotLeavesTheStoreAsGoodAsBefore) {
  JournaledFlight journaled;
  journaled.Fly(10);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(journaled.Snapshot(journaled.flight.atlas(), stop.get_token()));
  // A server that died between the pieces of a snapshot and its row.
  ASSERT_TRUE(journaled.store.database().Execute("INSERT INTO snapshot_chunks VALUES(1, 0, x'00')"));
  EXPECT_EQ(Fingerprint(journaled.Recover().atlas), Fingerprint(journaled.flight.atlas()));
  ASSERT_TRUE(journaled.Snapshot(journaled.flight.atlas()));
  EXPECT_EQ(Fingerprint(journaled.Recover().atlas), Fingerprint(journaled.flight.atlas()));
  EXPECT_EQ(journaled.Count("(SELECT DISTINCT snapshot FROM snapshot_chunks)"), 1);
}

TEST(Recovery, DataOfCulledKeyframesIsRemovedWithTheNextSnapshot) {
  JournaledFlight journaled;
  journaled.Fly(5);
  ASSERT_TRUE(journaled.Snapshot(journaled.flight.atlas()));
  journaled.Append({RemoveKeyframe{K(5)}});
  const RecoveredAtlas before = journaled.Recover();
  EXPECT_EQ(before.atlas.keyframe_count(), 4u);
  ASSERT_TRUE(journaled.Snapshot(before.atlas));
  EXPECT_EQ(journaled.Count("keyframe_payloads"), 4);
  EXPECT_EQ(Fingerprint(journaled.Recover().atlas), Fingerprint(before.atlas));
}

TEST(Recovery, TheJournalSinceTheOldestKeptSnapshotStays) {
  JournaledFlight journaled;
  journaled.Fly(10);
  ASSERT_TRUE(journaled.Keep(journaled.flight.atlas()));
  journaled.Fly(5);
  ASSERT_TRUE(journaled.Snapshot(journaled.flight.atlas()));
  EXPECT_EQ(journaled.Count("envelopes"), 5);
  EXPECT_EQ(journaled.Count("snapshots"), 2);
  const RecoveredAtlas recovered = journaled.Recover();
  EXPECT_EQ(recovered.snapshot_position, 15u) << "recovery takes the newest";
  EXPECT_EQ(Fingerprint(recovered.atlas), Fingerprint(journaled.flight.atlas()));
}

TEST(Recovery, OfKeptSnapshotsTheNewestStayAndNoMoreJournalThanIsWanted) {
  JournaledFlight journaled;
  journaled.retention.snapshots = 2;
  for (int i = 0; i < 3; ++i) {
    journaled.Fly(5);
    ASSERT_TRUE(journaled.Keep(journaled.flight.atlas()));
  }
  journaled.Fly(5);
  ASSERT_TRUE(journaled.Snapshot(journaled.flight.atlas()));
  EXPECT_EQ(journaled.Count("snapshots WHERE kept"), 2);
  EXPECT_EQ(journaled.Count("envelopes"), 10) << "those after the older of the two";
  journaled.retention.journal_bytes = 1;
  ASSERT_TRUE(journaled.Snapshot(journaled.flight.atlas()));
  EXPECT_EQ(journaled.Count("snapshots"), 1);
  EXPECT_EQ(journaled.Count("envelopes"), 0);
  EXPECT_EQ(Fingerprint(journaled.Recover().atlas), Fingerprint(journaled.flight.atlas()));
}

TEST(Recovery, DataOfCulledKeyframesStaysAsLongAsAKeptSnapshotHasThem) {
  JournaledFlight journaled;
  journaled.Fly(5);
  ASSERT_TRUE(journaled.Keep(journaled.flight.atlas()));
  journaled.Append({RemoveKeyframe{K(5)}});
  const Atlas culled = journaled.Recover().atlas;
  ASSERT_TRUE(journaled.Snapshot(culled));
  EXPECT_EQ(journaled.Count("keyframe_payloads"), 5);
  journaled.retention.snapshots = 0;
  ASSERT_TRUE(journaled.Snapshot(culled));
  EXPECT_EQ(journaled.Count("keyframe_payloads"), 4);
}

TEST(Recovery, AStoreOfTheFirstSchemaIsReadAndUpgradedWhenAServerOpensIt) {
  auto journaled = std::make_unique<JournaledFlight>();
  journaled->Fly(5);
  ASSERT_TRUE(journaled->store.database().Execute(R"(
    DROP TABLE work_times; DROP TABLE separations; ALTER TABLE snapshots DROP COLUMN kept; ALTER TABLE server_edits DROP COLUMN undone;
    ALTER TABLE keyframe_payloads DROP COLUMN missing_since; PRAGMA user_version=1)"));
  EXPECT_EQ(Fingerprint(journaled->Recover().atlas), Fingerprint(journaled->flight.atlas()));
  const std::filesystem::path path = journaled->place.path();
  journaled->store = Store::Open(path.parent_path() / "other.db", "hall", {}).value();
  const auto upgraded = Store::Open(path, "hall", {});
  ASSERT_TRUE(upgraded) << upgraded.error().message;
  EXPECT_TRUE(journaled->Snapshot(journaled->flight.atlas()));
  EXPECT_EQ(Fingerprint(journaled->Recover().atlas), Fingerprint(journaled->flight.atlas()));
}

TEST(Recovery, AStoreOfTheSecondSchemaIsReadAndKeepsTimesOnceAServerOpenedIt) {
  auto journaled = std::make_unique<JournaledFlight>();
  journaled->Fly(5);
  const std::filesystem::path path = journaled->place.path();
  ASSERT_TRUE(journaled->store.database().Execute("DROP TABLE work_times; PRAGMA user_version=2"));
  EXPECT_EQ(Store::OpenReadOnly(path)->WorkTimes()->size(), 0u);
  journaled->store = Store::Open(path.parent_path() / "other.db", "hall", {}).value();
  auto upgraded = Store::Open(path, "hall", {});
  ASSERT_TRUE(upgraded) << upgraded.error().message;
  JournalBatch batch;
  batch.work_times = {{"merge", 1.0, 1.0, 1}};
  EXPECT_TRUE(upgraded->Append(batch));
  EXPECT_EQ(upgraded->WorkTimes()->size(), 1u);
  EXPECT_EQ(Fingerprint(journaled->Recover().atlas), Fingerprint(journaled->flight.atlas()));
}

void ExpectCorrupt(JournaledFlight& journaled, const char* sql) {
  ASSERT_TRUE(journaled.store.database().Execute(sql));
  const auto recovered = RecoverAtlas(journaled.store);
  ASSERT_FALSE(recovered) << sql;
  EXPECT_EQ(recovered.error().code, ErrorCode::kCorrupt) << recovered.error().message;
}

TEST(Recovery, AMissingJournalEntryIsAnErrorNotASmallerAtlas) {
  JournaledFlight journaled;
  journaled.Fly(5);
  ExpectCorrupt(journaled, "DELETE FROM envelopes WHERE position = 3");
}

TEST(Recovery, ADamagedJournalEntryIsAnError) {
  JournaledFlight journaled;
  journaled.Fly(5);
  ExpectCorrupt(journaled, "UPDATE envelopes SET edits = x'0102' WHERE position = 3");
}

TEST(Recovery, ADamagedSnapshotIsAnError) {
  JournaledFlight journaled;
  journaled.Fly(5);
  ASSERT_TRUE(journaled.Snapshot(journaled.flight.atlas()));
  ExpectCorrupt(journaled, "UPDATE snapshot_chunks SET bytes = x'0102'");
}

TEST(Recovery, MissingKeyframeDataIsAnError) {
  JournaledFlight journaled;
  journaled.Fly(5);
  ASSERT_TRUE(journaled.Snapshot(journaled.flight.atlas()));
  ExpectCorrupt(journaled, "DELETE FROM keyframe_payloads WHERE counter = 2");
}

}  // namespace
}  // namespace pangaea
