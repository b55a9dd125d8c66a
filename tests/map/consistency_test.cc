#include "common/map/consistency.h"

#include <gtest/gtest.h>

#include "common/map/atlas_editor.h"
#include "tests/map/small_world.h"

namespace pangaea {

// Opens an atlas to changes that Apply would never make.
struct BrokenAtlas {
  SmallWorld world = RowOfThree();
  AtlasEditor editor{world.atlas};

  bool IsFound() const { return !CheckConsistency(world.atlas).empty(); }
};

namespace {

TEST(Consistency, ASoundAtlasHasNoFaults) { EXPECT_FALSE(BrokenAtlas().IsFound()); }

TEST(Consistency, AnObservationThatItsLandmarkDoesNotKnowIsFound) {
  BrokenAtlas broken;
  broken.editor.WriteKeyframe(K(3)).landmarks[9] = L(1);
  EXPECT_TRUE(broken.IsFound());
}

TEST(Consistency, AnObservationThatItsKeyframeDoesNotKnowIsFound) {
  BrokenAtlas broken;
  broken.editor.WriteKeyframe(K(3)).landmarks[3] = {};
  EXPECT_TRUE(broken.IsFound());
}

TEST(Consistency, AWrongWeightIsFound) {
  BrokenAtlas broken;
  broken.editor.WriteKeyframe(K(1)).covisible[0].weight = 2;
  EXPECT_TRUE(broken.IsFound());
}

TEST(Consistency, AReferenceThatDoesNotObserveIsFound) {
  BrokenAtlas broken;
  broken.editor.WriteLandmark(L(1)).reference = K(3);
  EXPECT_TRUE(broken.IsFound());
}

TEST(Consistency, ACircleInTheTreeIsFound) {
  BrokenAtlas broken;
  broken.editor.SetParent(K(2), K(3));
  EXPECT_TRUE(broken.IsFound());
}

TEST(Consistency, AChildThatItsParentDoesNotKnowIsFound) {
  BrokenAtlas broken;
  broken.editor.WriteKeyframe(K(2)).children.clear();
  EXPECT_TRUE(broken.IsFound());
}

TEST(Consistency, WrongCountsAreFound) {
  BrokenAtlas broken;
  ++broken.editor.WriteMap(M(1)).landmarks;
  EXPECT_TRUE(broken.IsFound());
}

TEST(Consistency, FramesOutOfOrderAreFound) {
  BrokenAtlas broken;
  broken.editor.WriteKeyframe(K(2)).frames =
      std::make_shared<std::vector<FramePose>>(std::vector<FramePose>{{2, {}, kAnna}, {1, {}, kAnna}});
  EXPECT_TRUE(broken.IsFound());
}

TEST(Consistency, ForwardingToNothingIsFound) {
  BrokenAtlas broken;
  const CulledKeyframe culled{K(8), Rigid3d()};
  broken.editor.WriteFormerKeyframe(K(9), &culled);
  EXPECT_TRUE(broken.IsFound());
}

TEST(Consistency, APositionThatIsNotFiniteIsFound) {
  BrokenAtlas broken;
  broken.editor.WriteLandmark(L(1)).point_in_map.x() = std::nan("");
  EXPECT_TRUE(broken.IsFound());
}

TEST(Consistency, ALoopEdgeToWhatIsNotAliveIsFound) {
  BrokenAtlas broken;
  broken.editor.WriteLoopEdges().push_back({K(1), K(9), {}});
  EXPECT_TRUE(broken.IsFound());
}

}  // namespace
}  // namespace pangaea
