#include "common/wire/envelope.h"

#include <gtest/gtest.h>

#include <random>

#include "common/base/hash.h"
#include "common/map/map_edit.h"

namespace pangaea {
namespace {

constexpr SessionId kSession = 0xfeedULL;

std::vector<MapEdit> SomeEdits() {
  return {RemoveLandmark{{kSession, 7}}, FuseLandmarks{{kSession, 1}, {kSession, 2}}, CloseMap{{kSession, 1}}};
}

TEST(Envelope, HoldsTheEditsItWasMadeOf) {
  const Envelope envelope = MakeEnvelope(kSession, 3, 9, SomeEdits());
  EXPECT_EQ(envelope.session, kSession);
  EXPECT_EQ(envelope.sequence, 3U);
  EXPECT_EQ(envelope.base_correction_version, 9U);
  EXPECT_TRUE(CheckEnvelope(envelope));
  const auto edits = DecodeEdits(envelope.edits);
  ASSERT_TRUE(edits);
  EXPECT_EQ(EncodeEdits(*edits), envelope.edits);
  ASSERT_EQ(edits->size(), 3U);
  EXPECT_EQ(std::get<FuseLandmarks>((*edits)[1]).absorbed, (LandmarkId{kSession, 2}));
}

TEST(Envelope, OneFlippedBitAnywhereFailsTheChecksum) {
  Envelope envelope = MakeEnvelope(kSession, 1, 0, SomeEdits());
  for (std::byte& octet : envelope.edits) {
    octet ^= std::byte{0x10};
    const Status status = CheckEnvelope(envelope);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, ErrorCode::kCorrupt);
    octet ^= std::byte{0x10};
  }
}

TEST(Envelope, AnUnknownWireVersionIsUnsupported) {
  Envelope envelope = MakeEnvelope(kSession, 1, 0, SomeEdits());
  for (const std::uint32_t version : {0U, kWireVersion + 1, 0xffffffffU}) {
    envelope.wire_version = version;
    const Status status = CheckEnvelope(envelope);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, ErrorCode::kUnsupported);
  }
}

TEST(Envelope, BeyondTheSizeLimitIsInvalidEvenWithAGoodChecksum) {
  Envelope envelope = MakeEnvelope(kSession, 1, 0, {});
  envelope.edits.assign(kMaxEnvelopeBytes + 1, std::byte{1});
  envelope.checksum = Hash64(envelope.edits);
  const Status status = CheckEnvelope(envelope);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
}

TEST(Envelope, WithoutSessionOrSequenceIsInvalid) {
  EXPECT_FALSE(CheckEnvelope(MakeEnvelope(0, 1, 0, SomeEdits())));
  EXPECT_FALSE(CheckEnvelope(MakeEnvelope(kSession, 0, 0, SomeEdits())));
}

TEST(Envelope, RandomOctetsWithAGoodChecksumDecodeToAnErrorOrToEdits) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 2000; ++round) {
    Envelope envelope = MakeEnvelope(kSession, 1, 0, {});
    envelope.edits.resize(random() % 200);
    for (std::byte& octet : envelope.edits) octet = static_cast<std::byte>(random());
    envelope.checksum = Hash64(envelope.edits);
    ASSERT_TRUE(CheckEnvelope(envelope));
    const auto edits = DecodeEdits(envelope.edits);
    if (edits) {
      EXPECT_LE(edits->size(), envelope.edits.size());
    }
  }
}

}  // namespace
}  // namespace pangaea
