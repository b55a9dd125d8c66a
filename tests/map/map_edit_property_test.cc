#include <gtest/gtest.h>

#include <set>
#include <string_view>

#include "common/map/atlas_codec.h"
#include "common/map/consistency.h"
#include "common/map/digest.h"
#include "tests/map/random_edits.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

constexpr int kSeeds = 30;
constexpr int kEdits = 400;

// The edit after a journey through the codec.
MapEdit Sent(const MapEdit& edit) {
  const auto decoded = DecodeEdits(EncodeEdits(std::span(&edit, 1)));
  EXPECT_TRUE(decoded && decoded->size() == 1) << KindName(edit);
  return decoded->front();
}

class RandomEditsTest : public testing::TestWithParam<int> {};

TEST_P(RandomEditsTest, TheAtlasIsConsistentAfterEveryEdit) {
  RandomEdits edits(static_cast<std::uint64_t>(GetParam()));
  Atlas atlas;
  for (int i = 0; i < kEdits; ++i) {
    const MapEdit edit = edits.Next(atlas);
    if (!Apply(edit, atlas)) continue;
    const auto faults = CheckConsistency(atlas);
    ASSERT_TRUE(faults.empty()) << i << " " << KindName(edit) << ": " << faults.front();
  }
}

TEST_P(RandomEditsTest, AnEditThatIsRefusedChangesNothing) {
  RandomEdits edits(static_cast<std::uint64_t>(GetParam()));
  Atlas atlas;
  int refused = 0;
  for (int i = 0; i < kEdits; ++i) {
    const MapEdit edit = edits.Next(atlas);
    const auto before = Fingerprint(atlas);
    const std::uint64_t digest = Digest(atlas);
    if (Apply(edit, atlas)) continue;
    ++refused;
    ASSERT_EQ(Fingerprint(atlas), before) << KindName(edit);
    ASSERT_EQ(Digest(atlas), digest) << KindName(edit);
  }
  EXPECT_GT(refused, 0);
}

TEST_P(RandomEditsTest, ASnapshotIsUnchangedByLaterEdits) {
  RandomEdits edits(static_cast<std::uint64_t>(GetParam()));
  Atlas atlas;
  for (int i = 0; i < kEdits; ++i) {
    const Atlas snapshot = atlas;
    const auto before = Fingerprint(snapshot);
    (void)Apply(edits.Next(atlas), atlas);
    ASSERT_EQ(Fingerprint(snapshot), before) << i;
  }
}

TEST_P(RandomEditsTest, BothEndsOfTheWireHaveTheSameBits) {
  RandomEdits edits(static_cast<std::uint64_t>(GetParam()));
  Atlas agent;
  Atlas server;
  for (int i = 0; i < kEdits; ++i) {
    const MapEdit edit = edits.Next(agent);
    const bool taken = Apply(edit, agent).has_value();
    ASSERT_EQ(Apply(Sent(edit), server).has_value(), taken);
    ASSERT_EQ(Fingerprint(agent), Fingerprint(server)) << KindName(edit);
  }
  EXPECT_EQ(Digest(agent), Digest(server));
  for (const SessionId session : {kAnna, kBert}) {
    EXPECT_EQ(DigestOfSession(agent, session), DigestOfSession(server, session));
  }
}

TEST_P(RandomEditsTest, AStoredAtlasComesBackBitForBitAndGoesOnAlike) {
  RandomEdits edits(static_cast<std::uint64_t>(GetParam()));
  Atlas atlas;
  for (int i = 0; i < kEdits; ++i) (void)Apply(edits.Next(atlas), atlas);
  const auto bytes = EncodeAtlas(atlas);
  auto restored = DecodeAtlas(bytes, [&](KeyframeId id) { return atlas.FindKeyframe(id)->data; });
  ASSERT_TRUE(restored) << restored.error().message;
  EXPECT_EQ(EncodeAtlas(*restored), bytes);
  EXPECT_TRUE(CheckConsistency(*restored).empty());
  for (int i = 0; i < kEdits / 4; ++i) {
    const MapEdit edit = edits.Next(atlas);
    ASSERT_EQ(Apply(edit, atlas).has_value(), Apply(edit, *restored).has_value()) << KindName(edit);
    ASSERT_EQ(EncodeAtlas(*restored), EncodeAtlas(atlas)) << KindName(edit);
  }
}

// That the tests above mean something.
TEST(RandomEdits, EveryKindIsTakenAndRefused) {
  std::set<std::string_view> taken;
  std::set<std::string_view> refused;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    RandomEdits edits(seed);
    Atlas atlas;
    for (int i = 0; i < kEdits; ++i) {
      const MapEdit edit = edits.Next(atlas);
      (Apply(edit, atlas) ? taken : refused).insert(KindName(edit));
    }
  }
  EXPECT_EQ(taken.size(), std::variant_size_v<MapEdit>);
  EXPECT_EQ(refused.size(), std::variant_size_v<MapEdit>);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomEditsTest, testing::Range(1, kSeeds + 1));

}  // namespace
}  // namespace pangaea
