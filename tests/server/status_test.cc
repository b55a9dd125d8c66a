#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/map/digest.h"
#include "server/runtime/status_json.h"
#include "tests/map/small_world.h"
#include "tests/server/service_harness.h"

namespace pangaea {
namespace {

using nlohmann::json;

json StatusOf(const ServiceHarness& harness) {
  DigestCache digests;
  ServerFacts facts;
  facts.site = "hall";
  facts.store_path = "atlas.db";
  facts.incarnation = harness.service->incarnation();
  return json::parse(StatusJson(*harness.service->State(), facts, digests));
}

TEST(StatusJson, TellsMapsAndSessions) {
  const TemporaryStore place;
  ServiceHarness harness(place.path());
  Flight flight(kAnna);
  harness.service->Submit(SessionAnnounced{flight.Announcement("hall"), {2, 100}});
  for (int i = 0; i < 3; ++i) harness.Send(flight.Next());
  harness.service->Stop();
  const json status = StatusOf(harness);
  EXPECT_EQ(status.at("site"), "hall");
  ASSERT_EQ(status.at("maps").size(), 1u);
  const json& map = status["maps"][0];
  EXPECT_EQ(map.at("id"), ToString(M(1)));
  EXPECT_EQ(map.at("keyframes"), 3);
  EXPECT_EQ(map.at("landmarks"), flight.atlas().landmark_count());
  EXPECT_EQ(map.at("sessions"), json::array({ToString(kAnna)}));
  ASSERT_EQ(status.at("sessions").size(), 1u);
  const json& session = status["sessions"][0];
  EXPECT_EQ(session.at("id"), ToString(kAnna));
  EXPECT_EQ(session.at("name"), flight.Announcement("hall").name);
  EXPECT_EQ(session.at("alive"), true);
  EXPECT_EQ(session.at("keyframes"), 3);
  EXPECT_EQ(session.at("acknowledged"), 3);
  for (const char* key : {"store", "queues", "memory_mib", "versions"}) EXPECT_TRUE(status.contains(key)) << key;
  EXPECT_GT(status["memory_mib"], 0.0);
}

TEST(StatusJson, CarriesTheDigestOnceTheAgentHasEnded) {
  const TemporaryStore place;
  ServiceHarness harness(place.path());
  Flight flight(kAnna);
  SessionAnnouncement announcement = flight.Announcement("hall");
  harness.service->Submit(SessionAnnounced{announcement, {2, 100}});
  harness.Send(flight.Next());
  harness.WaitForAck(kAnna, 1);
  EXPECT_FALSE(StatusOf(harness)["sessions"][0].contains("digest"));
  announcement.closed = true;
  harness.service->Submit(SessionAnnounced{announcement, {2, 100}});
  harness.service->Stop();
  const json status = StatusOf(harness);
  EXPECT_EQ(status["sessions"][0].at("alive"), false);
  EXPECT_EQ(status["sessions"][0].at("digest"), ToString(DigestOfSession(flight.atlas(), kAnna)));
  EXPECT_EQ(status["maps"][0].at("digest"), ToString(Digest(flight.atlas(), M(1))));
}

TEST(StatusJson, ANameThatIsNoTextStillGivesJson) {
  ServiceState state;
  SessionRecord record;
  record.announcement.session = kAnna;
  record.announcement.name = "a\xff\xfe\"b";
  state.ingest.sessions.emplace(kAnna, IngestSession(record));
  DigestCache digests;
  EXPECT_EQ(json::parse(StatusJson(state, {}, digests)).at("sessions").size(), 1u);
}

TEST(DigestCache, ComputesAnewWhenSomethingWasAcknowledged) {
  DigestCache digests;
  Flight flight(kAnna);
  flight.Next();
  const std::uint64_t first = digests.OfSession(flight.atlas(), kAnna, 1);
  flight.Next();
  EXPECT_EQ(digests.OfSession(flight.atlas(), kAnna, 1), first) << "remembered";
  EXPECT_EQ(digests.OfSession(flight.atlas(), kAnna, 2), DigestOfSession(flight.atlas(), kAnna));
}

TEST(LatencyWindow, TellsQuantilesOfTheNewestValues) {
  LatencyWindow window;
  EXPECT_EQ(window.Quantile(0.5), 0.0);
  for (int i = 1; i <= 101; ++i) window.Add(i);
  EXPECT_EQ(window.Quantile(0.5), 51.0);
  EXPECT_EQ(window.Quantile(1.0), 101.0);
  for (int i = 0; i < 1000; ++i) window.Add(7.0);
  EXPECT_EQ(window.Quantile(0.0), 7.0);
}

}  // namespace
}  // namespace pangaea
