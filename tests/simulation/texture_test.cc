#include "common/simulation/texture.h"

#include <gtest/gtest.h>

#include <vector>

#include "common/simulation/texture_filter.h"

namespace pangaea {
namespace {

Texture Ramp(int width, int height, int levels) {
  std::vector<std::uint8_t> texels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) texels.push_back(static_cast<std::uint8_t>(4 * x + y));
  }
  return Texture(width, height, levels, texels);
}

TEST(Texture, EveryLevelIsTheMeanOfTheFinerOne) {
  const Texture texture = Ramp(32, 16, 4);
  for (int l = 1; l < texture.level_count(); ++l) {
    const Texture::Level& fine = texture.level(l - 1);
    const Texture::Level& coarse = texture.level(l);
    for (int y = 0; y < coarse.height; ++y) {
      for (int x = 0; x < coarse.width; ++x) {
        const std::uint8_t* f = fine.origin + 2 * y * fine.stride + 2 * x;
        EXPECT_NEAR(coarse.origin[y * coarse.stride + x], 0.25 * (f[0] + f[1] + f[fine.stride] + f[fine.stride + 1]),
                    0.51);
      }
    }
  }
}

TEST(Texture, ALinearRampReadsTheSameAtEveryLevelOfDetail) {
  const Texture texture = Ramp(32, 16, 3);
  for (const float s : {0.3F, 0.41F, 0.5F, 0.66F}) {
    const float finest = SampleTrilinear(texture, 0.0F, s, 0.5F);
    EXPECT_NEAR(finest, 4.0F * (s * 32.0F - 0.5F) + 7.5F, 0.01F);
    for (const float level : {0.5F, 1.0F, 1.7F, 2.0F}) {
      EXPECT_NEAR(SampleTrilinear(texture, level, s, 0.5F), finest, 1.1F) << "level " << level;
    }
  }
}

TEST(TextureFilter, AFootprintFourTimesLongerThanWideGetsFourProbesAlongIt) {
  const Texture texture = Ramp(32, 32, 4);
  const Footprint footprint{2.0F / 32.0F, 0.0F, 0.0F, 8.0F / 32.0F};
  const TextureFilter filter = ChooseFilter(texture, footprint, 4);
  EXPECT_EQ(filter.probes, 4);
  EXPECT_NEAR(filter.step_s, 0.0F, 1e-6F);
  EXPECT_NEAR(filter.step_t, 2.0F / 32.0F, 1e-6F);
  EXPECT_NEAR(filter.level, 1.0F, 0.35F);
}

}  // namespace
}  // namespace pangaea
