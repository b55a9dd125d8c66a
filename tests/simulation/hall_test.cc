#include "common/simulation/hall.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "common/base/hash.h"

namespace pangaea {
namespace {

std::uint64_t Digest(const Texture& texture) {
  std::vector<std::byte> bytes;
  for (int y = 0; y < texture.height(); ++y) {
    for (int x = 0; x < texture.width(); ++x) bytes.push_back(static_cast<std::byte>(texture.Texel(x, y)));
  }
  return Hash64(bytes);
}

std::vector<std::uint64_t> Digests(const Scene& scene) {
  std::vector<std::uint64_t> digests;
  for (const Surface& surface : scene.surfaces) digests.push_back(Digest(*surface.texture));
  return digests;
}

TEST(Hall, IsTheSameWhateverTheNumberOfThreads) {
  HallOptions options;
  options.seed = 3;
  options.coarseness = 3.0;
  const Scene one = BuildHall(options);
  options.jobs = 3;
  const Scene three = BuildHall(options);
  ASSERT_EQ(one.surfaces.size(), three.surfaces.size());
  EXPECT_EQ(Digests(one), Digests(three));
}

TEST(Hall, NoTwoSurfacesShowTheSamePicture) {
  const std::vector<std::uint64_t> digests = Digests(BuildHall({}));
  EXPECT_GT(digests.size(), 1000U);
  EXPECT_EQ(std::set<std::uint64_t>(digests.begin(), digests.end()).size(), digests.size());
}

TEST(Hall, AnotherSeedIsAnotherHall) {
  HallOptions options;
  options.coarseness = 3.0;
  HallOptions other = options;
  other.seed = 2;
  const std::vector<std::uint64_t> one = Digests(BuildHall(options));
  const std::vector<std::uint64_t> two = Digests(BuildHall(other));
  const std::set<std::uint64_t> of_one(one.begin(), one.end());
  for (const std::uint64_t digest : two) EXPECT_EQ(of_one.count(digest), 0U);
}

TEST(Scene, ClearanceIsTheDistanceToTheNearestSolidOrWall) {
  Scene scene;
  scene.half_size = {5.0, 4.0, 3.0};
  scene.solids.push_back({{0.0, 0.0, 1.0}, {1.0, 0.5, 1.0}, {0.0, 1.0}});  // a quarter turn: 1 m wide, 2 m long
  EXPECT_NEAR(scene.Clearance({1.5, 0.0, 1.0}), 1.0, 1e-12);
  EXPECT_NEAR(scene.Clearance({0.0, 1.4, 1.0}), 0.4, 1e-12);
  EXPECT_NEAR(scene.Clearance({4.8, 0.0, 1.0}), 0.2, 1e-12);
  EXPECT_LT(scene.Clearance({0.0, 0.0, 1.0}), 0.0);
}

}  // namespace
}  // namespace pangaea
