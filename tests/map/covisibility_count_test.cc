#include "common/map/covisibility_count.h"

#include <gtest/gtest.h>

#include "tests/map/random_edits.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

TEST(CovisibilityCount, CountsWhatEditsHaveKept) {
  std::size_t edges_of_all = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Atlas atlas;
    RandomEdits random(seed);
    for (int i = 0; i < 600; ++i) (void)Apply(random.Next(atlas), atlas);
    CovisibilityCount count;
    atlas.ForEachLandmark([&](const Landmark& landmark) { count.Add(landmark.observations); });
    std::size_t edges = 0;
    count.ForEach([&](KeyframeId id, const std::vector<Covisibility>& covisible) {
      EXPECT_EQ(covisible, atlas.FindKeyframe(id)->covisible) << ToString(id);
      edges += covisible.size();
    });
    std::size_t expected = 0;
    atlas.ForEachKeyframe([&](const Keyframe& keyframe) { expected += keyframe.covisible.size(); });
    EXPECT_EQ(edges, expected);
    edges_of_all += edges;
  }
  EXPECT_GT(edges_of_all, 100U);
}

}  // namespace
}  // namespace pangaea
