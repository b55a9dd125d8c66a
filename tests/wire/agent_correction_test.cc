#include "common/wire/agent_correction.h"

#include <gtest/gtest.h>

#include "common/base/hash.h"

namespace pangaea {
namespace {

AgentCorrection Correction(std::uint64_t version, std::size_t landmarks) {
  MapPiece piece;
  piece.map = {1, 1};
  for (std::uint32_t i = 1; i <= landmarks; ++i) piece.landmarks.push_back({{1, i}, {1.0, 2.0, i * 1.0}, {}, {}});
  return {1, 9, version, 4, {piece}};
}

TEST(AgentCorrection, PartsOfAnySizeGiveTheSameCorrection) {
  AgentCorrection sent = Correction(5, 300);
  sent.complete = true;
  for (const std::size_t size : {7U, 100U, 1000U, 1'000'000U}) {
    CorrectionAssembly assembly;
    std::optional<AgentCorrection> received;
    const auto parts = SplitCorrection(sent, size);
    for (const CorrectionPart& part : parts) {
      EXPECT_FALSE(received);
      EXPECT_LE(part.octets.size(), size);
      auto taken = assembly.Take(part);
      ASSERT_TRUE(taken) << taken.error().message;
      received = std::move(*taken);
    }
    ASSERT_TRUE(received);
    EXPECT_EQ(received->version, 5U);
    EXPECT_EQ(received->acknowledged, 4U);
    EXPECT_TRUE(received->complete);
    EXPECT_EQ(EncodePieces(received->pieces), EncodePieces(sent.pieces));
  }
}

TEST(AgentCorrection, ANewerOneDisplacesOneThatIsNotComplete) {
  const auto older = SplitCorrection(Correction(5, 100), 1000);
  const auto newer = SplitCorrection(Correction(6, 20), 1000);
  CorrectionAssembly assembly;
  EXPECT_FALSE(assembly.Take(older[0]).value());
  EXPECT_FALSE(assembly.Take(older[1]).value());
  ASSERT_EQ(newer.size(), 1U);
  EXPECT_EQ(assembly.Take(newer[0]).value()->version, 6U);
  for (std::size_t i = 2; i < older.size(); ++i) EXPECT_FALSE(assembly.Take(older[i]).value());
}

TEST(AgentCorrection, PartsThatDoNotFollowGiveNothing) {
  const auto parts = SplitCorrection(Correction(5, 100), 1000);
  ASSERT_GE(parts.size(), 3U);
  CorrectionAssembly assembly;
  EXPECT_FALSE(assembly.Take(parts[1]).value());  // the beginning was lost
  EXPECT_FALSE(assembly.Take(parts[0]).value());
  EXPECT_FALSE(assembly.Take(parts[2]).value());
  EXPECT_FALSE(assembly.Take(parts[0]).value());  // sent again
  for (std::size_t i = 1; i + 1 < parts.size(); ++i) EXPECT_FALSE(assembly.Take(parts[i]).value());
  EXPECT_TRUE(assembly.Take(parts.back()).value());
}

TEST(AgentCorrection, DamagedOctetsAreAnError) {
  auto parts = SplitCorrection(Correction(5, 10));
  parts[0].octets[3] ^= std::byte{1};
  EXPECT_EQ(CorrectionAssembly().Take(parts[0]).error().code, ErrorCode::kCorrupt);
  parts[0].checksum = Hash64(parts[0].octets);
  EXPECT_FALSE(CorrectionAssembly().Take(parts[0]));
}

}  // namespace
}  // namespace pangaea
