#include "server/storage/store.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/map/small_world.h"
#include "tests/server/flight.h"
#include "tests/server/temporary_store.h"

namespace pangaea {
namespace {

Store OpenStore(const TemporaryStore& place, const StoreOptions& options = {}) {
  auto store = Store::Open(place.path(), "hall", options);
  EXPECT_TRUE(store) << store.error().message;
  return std::move(*store);
}

SessionRecord RecordOf(const Flight& flight, std::uint64_t acknowledged) {
  return {flight.Announcement("hall"), 4321, acknowledged, 0};
}

std::vector<JournalEntry> EntriesAfter(Store& store, std::uint64_t position) {
  std::vector<JournalEntry> entries;
  const Status status = store.ForEachEditsAfter(position, [&entries](const JournalEntry& entry) {
    entries.push_back(entry);
    return Status();
  });
  EXPECT_TRUE(status) << status.error().message;
  return entries;
}

TEST(Store, KeepsEnvelopesVerbatimAndInOrder) {
  const TemporaryStore place;
  Flight flight(0xfedcba9876543210);  // the highest bit set: stored as a negative number
  const Envelope first = flight.Next();
  const Envelope second = flight.Next();
  {
    Store store = OpenStore(place);
    ASSERT_TRUE(store.Append({{{1, first}, {2, second}}, {}, {}, {RecordOf(flight, 2)}}));
  }
  Store store = OpenStore(place);
  const auto entries = EntriesAfter(store, 0);
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].envelope, first);
  EXPECT_EQ(entries[1].envelope, second);
  EXPECT_EQ(EntriesAfter(store, 1).size(), 1u);
}

TEST(Store, KeepsSessionsWithTheirRigs) {
  const TemporaryStore place;
  const Flight flight(kAnna);
  Store store = OpenStore(place);
  ASSERT_TRUE(store.Append({{}, {}, {}, {RecordOf(flight, 2)}}));
  ASSERT_TRUE(store.Append({{}, {}, {}, {RecordOf(flight, 3)}}));
  const auto sessions = store.Sessions().value();
  ASSERT_EQ(sessions.size(), 1u);
  const SessionAnnouncement expected = flight.Announcement("hall");
  const SessionAnnouncement& stored = sessions[0].announcement;
  EXPECT_EQ(stored.session, expected.session);
  EXPECT_EQ(stored.name, expected.name);
  EXPECT_EQ(stored.site, "hall");
  EXPECT_EQ(stored.ideal_camera, expected.ideal_camera);
  EXPECT_TRUE(SameBits(stored.body_from_camera, expected.body_from_camera));
  EXPECT_EQ(sessions[0].acknowledged, 3u);
  EXPECT_EQ(sessions[0].joined_unix_ns, 4321);
}

TEST(Store, KeepsRejections) {
  const TemporaryStore place;
  Store store = OpenStore(place);
  ASSERT_TRUE(store.Append({{}, {}, {{kAnna, {5, RejectionReason::kChecksum, "damaged"}}}, {}}));
  const auto rejections = store.Rejections().value();
  ASSERT_EQ(rejections.size(), 1u);
  EXPECT_EQ(rejections[0].session, kAnna);
  EXPECT_EQ(rejections[0].rejection, (Rejection{5, RejectionReason::kChecksum, "damaged"}));
}

TEST(Store, OrdersTheServersOwnEditsAmongTheEnvelopes) {
  const TemporaryStore place;
  Flight flight(kAnna);
  Store store = OpenStore(place);
  const std::vector<MapEdit> own{CloseMap{M(1)}};
  ASSERT_TRUE(store.Append({{{1, flight.Next()}, {3, flight.Next()}}, {{2, "test", EncodeEdits(own)}}, {}, {}}));
  const auto entries = EntriesAfter(store, 0);
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_EQ(entries[1].position, 2u);
  EXPECT_EQ(entries[1].envelope.session, 0u);
  EXPECT_EQ(entries[1].envelope.edits, EncodeEdits(own));
}

TEST(Store, ABatchIsStoredWholeOrNotAtAll) {
  const TemporaryStore place;
  Flight flight(kAnna);
  const Envelope first = flight.Next();
  Store store = OpenStore(place);
  ASSERT_TRUE(store.Append({{{1, first}}, {}, {}, {}}));
  // The second entry has the number of the first one: the database refuses it.
  EXPECT_FALSE(store.Append({{{2, flight.Next()}, {3, first}}, {}, {}, {RecordOf(flight, 3)}}));
  EXPECT_EQ(EntriesAfter(store, 0).size(), 1u);
  EXPECT_TRUE(store.Sessions().value().empty());
}

TEST(Store, DiskFullOnTheServerRefusesTheBatchAndTakesItOnceThereIsRoom) {
  const TemporaryStore place;
  Flight flight(kAnna, {.keypoints = 1000});
  Store store = OpenStore(place, {.max_bytes = 1U << 20});
  std::uint64_t stored = 0;
  Status status;
  Envelope envelope = flight.Next();
  while (stored < 1000 && (status = store.Append({{{stored + 1, envelope}}, {}, {}, {}}))) {
    ++stored;
    envelope = flight.Next();
  }
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kUnavailable) << status.error().message;
  EXPECT_EQ(EntriesAfter(store, 0).size(), stored);
  ASSERT_TRUE(store.SetMaxBytes(0));
  EXPECT_TRUE(store.Probe());
  EXPECT_TRUE(store.Append({{{stored + 1, envelope}}, {}, {}, {}}));
  EXPECT_EQ(EntriesAfter(store, 0).size(), stored + 1);
}

TEST(Store, CountsItsIncarnations) {
  const TemporaryStore place;
  EXPECT_EQ(OpenStore(place).BeginIncarnation().value(), 1u);
  EXPECT_EQ(OpenStore(place).BeginIncarnation().value(), 2u);
}

TEST(Store, ASecondServerOnTheSameStoreIsRefused) {
  const TemporaryStore place;
  const Store first = OpenStore(place);
  const auto second = Store::Open(place.path(), "hall", {});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kUnavailable);
}

TEST(Store, TheStoreOfAnotherSiteIsRefused) {
  const TemporaryStore place;
  { const Store store = OpenStore(place); }
  const auto other = Store::Open(place.path(), "cellar", {});
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kRefused);
  EXPECT_NE(other.error().message.find("hall"), std::string::npos);
}

TEST(Store, KeepsTheTimesOfTheServersWorkInOrder) {
  const TemporaryStore place;
  {
    Store store = OpenStore(place);
    JournalBatch batch;
    EXPECT_TRUE(batch.empty());
    batch.work_times = {{"recognition", 5.25, 4.5, 100}, {"merge", 200.125, 0.0, 200}};
    EXPECT_FALSE(batch.empty());
    ASSERT_TRUE(store.Append(batch));
    ASSERT_TRUE(store.Append(batch));
  }
  const auto times = Store::OpenReadOnly(place.path())->WorkTimes();
  ASSERT_TRUE(times);
  ASSERT_EQ(times->size(), 4u);
  EXPECT_EQ((*times)[1].kind, "merge");
  EXPECT_EQ((*times)[1].unix_ns, 200);
  EXPECT_DOUBLE_EQ((*times)[2].wall_ms, 5.25);
  EXPECT_DOUBLE_EQ((*times)[2].cpu_ms, 4.5);
}

TEST(Store, ANewerSchemaIsRefused) {
  const TemporaryStore place;
  {
    Store store = OpenStore(place);
    ASSERT_TRUE(store.database().Execute("PRAGMA user_version=99"));
  }
  const auto newer = Store::Open(place.path(), "hall", {});
  ASSERT_FALSE(newer);
  EXPECT_EQ(newer.error().code, ErrorCode::kUnsupported);
  EXPECT_NE(newer.error().message.find("99"), std::string::npos);
}

TEST(Store, AFileThatIsNoStoreIsRefusedAndLeftAlone) {
  const TemporaryStore place;
  const std::string text(5000, 'x');
  std::ofstream(place.path()) << text;
  const auto store = Store::Open(place.path(), "hall", {});
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::kCorrupt) << store.error().message;
  std::ifstream file(place.path());
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), text);
}

TEST(Store, AnotherProgramsDatabaseIsRefused) {
  const TemporaryStore place;
  ASSERT_TRUE(Database::Open(place.path(), Database::Access::kReadWrite)->Execute("CREATE TABLE diary(day TEXT)"));
  const auto store = Store::Open(place.path(), "hall", {});
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::kCorrupt);
}

TEST(Store, AFolderThatDoesNotExistIsAClearError) {
  const TemporaryStore place;
  const auto store = Store::Open(place.path() / "no" / "such.db", "hall", {});
  ASSERT_FALSE(store);
  EXPECT_NE(store.error().message.find("such.db"), std::string::npos);
}

TEST(Store, CanBeReadWhileAServerHasItOpen) {
  const TemporaryStore place;
  Flight flight(kAnna);
  Store server = OpenStore(place);
  auto reader = Store::OpenReadOnly(place.path());
  ASSERT_TRUE(reader) << reader.error().message;
  ASSERT_TRUE(server.Append({{{1, flight.Next()}}, {}, {}, {}}));
  EXPECT_EQ(EntriesAfter(*reader, 0).size(), 1u);
  EXPECT_EQ(reader->site(), "hall");
  EXPECT_FALSE(reader->Append({{{2, flight.Next()}}, {}, {}, {}}));
}

TEST(Store, ReadingOneThatDoesNotExistCreatesNothing) {
  const TemporaryStore place;
  const auto store = Store::OpenReadOnly(place.path());
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(std::filesystem::exists(place.path()));
}

TEST(Store, AQuotaTooSmallForTheTablesIsAnError) {
  EXPECT_FALSE((StoreOptions{.max_bytes = 1}.Check()));
  EXPECT_TRUE((StoreOptions{}.Check()));
}

}  // namespace
}  // namespace pangaea
