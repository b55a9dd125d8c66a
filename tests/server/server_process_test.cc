#include "tests/server/server_process.h"

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <random>

#include "common/map/digest.h"
#include "server/storage/recovery.h"
#include "tests/map/small_world.h"
#include "tests/server/dds_agent.h"
#include "tests/server/flight.h"
#include "tests/server/temporary_store.h"

namespace pangaea {
namespace {

constexpr const char* kSite = "hall";

class ServerProcessTest : public ::testing::Test {
 protected:
  ServerProcessTest() { UseOwnDiscoveryTag(); }

  std::vector<std::string> Arguments() const {
    return {"--site", kSite, "--store", place_.path().string(), "--log-level", "warn"};
  }
  RecoveredAtlas Stored() const {
    auto store = Store::OpenReadOnly(place_.path());
    EXPECT_TRUE(store);
    auto recovered = RecoverAtlas(*store);
    EXPECT_TRUE(recovered) << recovered.error().message;
    return recovered ? *recovered : RecoveredAtlas();
  }

  TemporaryStore place_;
};

std::vector<Envelope> EnvelopesOf(Flight& flight, int count) {
  std::vector<Envelope> envelopes;
  for (int i = 0; i < count; ++i) envelopes.push_back(flight.Next());
  return envelopes;
}

TEST_F(ServerProcessTest, ServerKilledAtRandomMomentsLosesNothingAckedAndTakesNothingTwice) {
  DdsAgent agent(kSite);
  Flight flight(kAnna, {.keypoints = 400});
  const std::vector<Envelope> envelopes = EnvelopesOf(flight, 150);
  agent.Announce(flight.Announcement(kSite));
  // Other moments in every run; a failure names its seed.
  const auto seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uint64_t acknowledged = 0;
  for (int life = 0; life < 3; ++life) {
    ServerProcess server(Arguments());
    // The moment of death: some way into the flight, while later envelopes are on their way.
    acknowledged = agent.SendUntilAcknowledged(envelopes, acknowledged + 5 + random() % 25);
    server.Signal(SIGKILL);
    EXPECT_EQ(server.Wait(), 128 + SIGKILL);
    const RecoveredAtlas stored = Stored();
    ASSERT_GE(stored.position, acknowledged) << "an acknowledged envelope is lost";
  }
  ServerProcess server(Arguments());
  agent.SendUntilAcknowledged(envelopes);
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(), 0);
  const RecoveredAtlas stored = Stored();
  EXPECT_EQ(Digest(stored.atlas), Digest(flight.atlas()));
  EXPECT_EQ(stored.atlas.version(), flight.atlas().version()) << "each edit once";
  EXPECT_EQ(stored.position, envelopes.size());
}

TEST_F(ServerProcessTest, CtrlCAndTerminationEndItInOrder) {
  for (const int signal : {SIGINT, SIGTERM}) {
    DdsAgent agent(kSite);
    ServerProcess server(Arguments());
    agent.WaitForStatus("\"incarnation\"");
    server.Signal(signal);
    EXPECT_EQ(server.Wait(), 0);
  }
}

TEST_F(ServerProcessTest, TheStatusShowsASessionsLife) {
  DdsAgent observer(kSite);
  ServerProcess server(Arguments());
  Flight flight(kAnna);
  SessionAnnouncement announcement = flight.Announcement(kSite);
  observer.Announce(announcement);
  observer.SendUntilAcknowledged(EnvelopesOf(flight, 5));
  observer.WaitForStatus("\"acknowledged\":5,\"alive\":true");
  announcement.closed = true;
  observer.Announce(announcement);
  const AtlasStatus ended = observer.WaitForStatus("\"acknowledged\":5,\"alive\":false");
  EXPECT_EQ(ended.site, kSite);
  EXPECT_EQ(ended.server_incarnation, 1u);
  EXPECT_NE(ended.json.find(ToString(DigestOfSession(flight.atlas(), kAnna))), std::string::npos);
}

TEST_F(ServerProcessTest, AnAgentThatVanishesIsNoticedAndItsSessionStays) {
  ServerProcess server(Arguments());
  Flight flight(kAnna);
  {
    DdsAgent agent(kSite);
    agent.Announce(flight.Announcement(kSite));
    agent.SendUntilAcknowledged(EnvelopesOf(flight, 5));
    agent.WaitForStatus("\"alive\":true");
  }
  DdsAgent observer(kSite);
  observer.WaitForStatus("\"acknowledged\":5,\"alive\":false");
  EXPECT_EQ(Digest(Stored().atlas), Digest(flight.atlas()));
}

TEST_F(ServerProcessTest, HostileMessagesDoNotStopIt) {
  DdsAgent agent(kSite);
  ServerProcess server(Arguments());
  Flight flight(kAnna);
  std::vector<Envelope> envelopes = EnvelopesOf(flight, 2);
  Envelope damaged = flight.NextWith({CloseMap{M(1)}});
  damaged.checksum ^= 1;
  envelopes.push_back(damaged);
  envelopes.push_back(flight.Next());
  Envelope huge = Flight(kBert).Next();
  huge.edits.assign(kMaxEnvelopeBytes + 1, std::byte{0});
  agent.Send(huge);
  agent.SendUntilAcknowledged(envelopes);
  EXPECT_EQ(Digest(Stored().atlas), Digest(flight.atlas()));
}

TEST_F(ServerProcessTest, BadOptionsAndStoresAreClearErrors) {
  EXPECT_EQ(ServerProcess({"--no-such-option"}).Wait(), 2);
  EXPECT_EQ(ServerProcess({"--site", "no spaces"}).Wait(), 2);
  EXPECT_EQ(ServerProcess({"--config", "/no/such/file.yaml"}).Wait(), 2);
  EXPECT_EQ(ServerProcess({"--store", (place_.path() / "no" / "such.db").string()}).Wait(), 1);
  std::ofstream(place_.path()) << std::string(5000, 'x');
  EXPECT_EQ(ServerProcess(Arguments()).Wait(), 1);
}

TEST_F(ServerProcessTest, HelpAndVersionSucceed) {
  EXPECT_EQ(ServerProcess({"--help"}).Wait(), 0);
  EXPECT_EQ(ServerProcess({"--version"}).Wait(), 0);
}

}  // namespace
}  // namespace pangaea
