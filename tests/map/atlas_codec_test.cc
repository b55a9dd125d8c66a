#include "common/map/atlas_codec.h"

#include <gtest/gtest.h>

#include <random>

#include "common/map/consistency.h"
#include "tests/map/random_edits.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

Result<std::shared_ptr<const KeyframeData>> AnyData(KeyframeId) { return MakeData(20); }

Atlas Eventful() {
  RandomEdits edits(3);
  Atlas atlas;
  for (int i = 0; i < 150; ++i) (void)Apply(edits.Next(atlas), atlas);
  return atlas;
}

TEST(AtlasCodec, AnEmptyAtlasComesBack) {
  const auto restored = DecodeAtlas(EncodeAtlas(Atlas()), AnyData);
  ASSERT_TRUE(restored);
  EXPECT_EQ(restored->keyframe_count(), 0u);
}

TEST(AtlasCodec, KeyframeDataComeBackAsTheyWere) {
  const auto data = MakeData(50, -123456789);
  ByteWriter writer;
  EncodeKeyframeData(*data, writer);
  ByteReader reader(writer.bytes());
  const auto restored = DecodeKeyframeData(reader);
  ASSERT_TRUE(restored);
  EXPECT_EQ((*restored)->stamp_ns, data->stamp_ns);
  EXPECT_EQ((*restored)->camera, data->camera);
  EXPECT_EQ((*restored)->features, data->features);
}

TEST(AtlasCodec, TruncationAnywhereIsAnError) {
  const auto bytes = EncodeAtlas(RowOfThree().atlas);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(DecodeAtlas(std::span(bytes).first(size), AnyData)) << size;
  }
}

TEST(AtlasCodec, CorruptionGivesAnErrorOrAConsistentAtlas) {
  const auto bytes = EncodeAtlas(Eventful());
  std::mt19937_64 random(9);
  for (int i = 0; i < 5000; ++i) {
    auto corrupt = bytes;
    corrupt[random() % corrupt.size()] = static_cast<std::byte>(random());
    const auto restored = DecodeAtlas(corrupt, AnyData);
    if (!restored) continue;
    const auto faults = CheckConsistency(*restored);
    ASSERT_TRUE(faults.empty()) << i << ": " << faults.front();
  }
}

TEST(AtlasCodec, MissingDataAreTheSourcesError) {
  const auto restored = DecodeAtlas(EncodeAtlas(RowOfThree().atlas), [](KeyframeId) {
    return Result<std::shared_ptr<const KeyframeData>>(Fail(ErrorCode::kNotFound, "no such blob"));
  });
  ASSERT_FALSE(restored);
  EXPECT_EQ(restored.error().message, "no such blob");
}

}  // namespace
}  // namespace pangaea
