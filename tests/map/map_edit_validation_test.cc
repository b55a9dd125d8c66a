#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/map/limits.h"
#include "common/map/map_edit.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

// The data of a keyframe after a change that makes them impossible.
template <typename Change>
AddKeyframe WithData(Change change) {
  auto data = std::make_shared<KeyframeData>(*MakeData(4));
  change(*data);
  return AddKeyframe{K(9), M(1), K(1), {}, data};
}

TEST(MapEditValidation, ANanPoseIsRefused) {
  SmallWorld world = RowOfThree();
  const Rigid3d pose(Eigen::Quaterniond::Identity(), {kNan, 0.0, 0.0});
  const Rigid3d turn(Eigen::Quaterniond(kNan, 0.0, 0.0, 0.0), {0.0, 0.0, 0.0});
  for (const Rigid3d& bad : {pose, turn}) {
    world.Refuse(AddKeyframe{K(9), M(1), K(1), bad, MakeData(3)}, ErrorCode::kInvalidArgument);
    world.Refuse(MoveKeyframes{{{K(2), {}}, {K(3), bad}}}, ErrorCode::kInvalidArgument);
    world.Refuse(AddFramePoses{{{K(2), {1, bad}}}}, ErrorCode::kInvalidArgument);
  }
  world.Refuse(AddLoopEdge{K(1), K(2), Similarity3d(pose)}, ErrorCode::kInvalidArgument);
}

TEST(MapEditValidation, UnknownReferencesAreRefused) {
  SmallWorld world = RowOfThree();
  world.Refuse(AddKeyframe{K(9), M(1), K(8), {}, MakeData(3)}, ErrorCode::kNotFound);
  world.Refuse(AddLandmark{L(9), K(8), 0, {0.0, 0.0, 1.0}}, ErrorCode::kNotFound);
  world.Refuse(AddObservation{L(9), K(1), 0}, ErrorCode::kNotFound);
  world.Refuse(AddObservation{L(1), K(8), 0}, ErrorCode::kNotFound);
  world.Refuse(RemoveObservation{L(9), K(1)}, ErrorCode::kNotFound);
  world.Refuse(MoveKeyframes{{{K(1), {}}, {K(8), {}}}}, ErrorCode::kNotFound);
  world.Refuse(MoveLandmarks{{{L(9), {0.0, 0.0, 1.0}}}}, ErrorCode::kNotFound);
  world.Refuse(FuseLandmarks{L(1), L(9)}, ErrorCode::kNotFound);
  world.Refuse(AddFramePoses{{{K(8), {1, {}}}}}, ErrorCode::kNotFound);
  world.Refuse(RemoveKeyframe{K(8)}, ErrorCode::kNotFound);
  world.Refuse(RemoveLandmark{L(9)}, ErrorCode::kNotFound);
  world.Refuse(AddLoopEdge{K(1), K(8), {}}, ErrorCode::kNotFound);
  world.Refuse(CloseMap{M(9)}, ErrorCode::kNotFound);
  world.Refuse(MergeMaps{M(1), M(9), {}, K(1), K(1)}, ErrorCode::kNotFound);
}

TEST(MapEditValidation, DuplicateIdsAreRefusedAlsoOfWhatIsForwarded) {
  SmallWorld world = RowOfThree();
  world.Do(FuseLandmarks{L(1), L(3)});
  world.Do(RemoveKeyframe{K(3)});
  for (const std::uint32_t counter : {2, 3}) {
    world.Refuse(AddKeyframe{K(counter), M(1), K(1), {}, MakeData(3)}, ErrorCode::kRefused);
  }
  for (const std::uint32_t counter : {1, 3}) {
    world.Refuse(AddLandmark{L(counter), K(1), 8, {0.0, 0.0, 1.0}}, ErrorCode::kRefused);
  }
  world.Refuse(AddKeyframe{K(9), M(1), {}, {}, MakeData(3)}, ErrorCode::kRefused);  // a second root
}

TEST(MapEditValidation, ALandmarkThatIsGoneMayComeBack) {
  SmallWorld world = RowOfThree();
  world.Do(RemoveLandmark{L(3)});
  world.Add(L(3), K(2), 8);
  EXPECT_EQ(world.Get(L(3)).reference, K(2));
}

TEST(MapEditValidation, IdsThatWouldBlowUpTablesAreRefused) {
  SmallWorld world = RowOfThree();
  world.Refuse(AddKeyframe{K(kMaxKeyframeCounter + 1), M(1), K(1), {}, MakeData(3)}, ErrorCode::kInvalidArgument);
  world.Refuse(AddLandmark{L(kMaxLandmarkCounter + 1), K(1), 8, {0, 0, 1}}, ErrorCode::kInvalidArgument);
  world.Refuse(AddLandmark{L(0), K(1), 8, {0, 0, 1}}, ErrorCode::kInvalidArgument);
  world.Refuse(AddLandmark{{0, 5}, K(1), 8, {0, 0, 1}}, ErrorCode::kInvalidArgument);
  world.Do(AddLandmark{L(kMaxLandmarkCounter), K(1), 8, {0, 0, 1}});
}

TEST(MapEditValidation, ImpossibleLandmarksAreRefused) {
  SmallWorld world = RowOfThree();
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0, 2e6), Eigen::Vector3d(kNan, 0, 1)}) {
    world.Refuse(AddLandmark{L(9), K(1), 8, point}, ErrorCode::kInvalidArgument);
    if (point.z() > 0.0 || std::isnan(point.x())) {
      world.Refuse(MoveLandmarks{{{L(1), point}}}, ErrorCode::kInvalidArgument);
    }
  }
  world.Refuse(AddLandmark{L(9), K(1), 20, {0, 0, 1}}, ErrorCode::kInvalidArgument);  // no such keypoint
}

TEST(MapEditValidation, ContradictingObservationsAreRefused) {
  SmallWorld world = RowOfThree();
  world.Refuse(AddObservation{L(1), K(3), 20}, ErrorCode::kInvalidArgument);  // no such keypoint
  world.Refuse(AddObservation{L(1), K(3), 99}, ErrorCode::kInvalidArgument);
  world.Observe(L(1), K(2), 1);  // said twice
  world.Root(K(9), M(2));
  world.Refuse(AddObservation{L(1), K(9), 9}, ErrorCode::kRefused);  // in another map
}

TEST(MapEditValidation, ImpossibleKeyframeDataAreRefused) {
  SmallWorld world = RowOfThree();
  const std::vector<AddKeyframe> impossible = {
      AddKeyframe{K(9), M(1), K(1), {}, nullptr},
      WithData([](KeyframeData& data) { data.camera.focal_x = 0.0; }),
      WithData([](KeyframeData& data) { data.camera.focal_y = kNan; }),
      WithData([](KeyframeData& data) { data.camera.center_x = kNan; }),
      WithData([](KeyframeData& data) { data.camera.baseline = -0.1; }),
      WithData([](KeyframeData& data) { data.camera.width = 0; }),
      WithData([](KeyframeData& data) { data.vergence = kNan; }),
      WithData([](KeyframeData& data) { data.features.descriptors.pop_back(); }),
      WithData([](KeyframeData& data) { data.features.keypoints[1].u = 752.0F; }),
      WithData([](KeyframeData& data) { data.features.keypoints[1].v = -1.0F; }),
      WithData([](KeyframeData& data) { data.features.keypoints[1].u_right = std::nanf(""); }),
      WithData([](KeyframeData& data) { data.features.keypoints[1].v += 0.01F; }),  // unquantised
      WithData([](KeyframeData& data) { data.features.keypoints[1].octave = kOctaves; }),
      WithData([](KeyframeData& data) {
        data.features.keypoints.resize(kMaxKeypoints + 1);
        data.features.descriptors.resize(kMaxKeypoints + 1);
      })};
  for (const AddKeyframe& edit : impossible) world.Refuse(edit, ErrorCode::kInvalidArgument);
  world.Do(WithData([](KeyframeData&) {}));
}

TEST(MapEditValidation, AClosedMapTakesNoKeyframes) {
  SmallWorld world = RowOfThree();
  world.Do(CloseMap{M(1)});
  world.Refuse(AddKeyframe{K(9), M(1), K(1), {}, MakeData(3)}, ErrorCode::kRefused);
  world.Add(L(9), K(1), 8);  // what came before its closing may still be refined
}

TEST(MapEditValidation, FramesOutOfOrderAreRefused) {
  SmallWorld world = RowOfThree();
  world.Refuse(AddFramePoses{{{K(1), {5, {}}}, {K(1), {5, {}}}}}, ErrorCode::kInvalidArgument);
}

TEST(MapEditValidation, MapsThatCannotBeMergedAreRefused) {
  SmallWorld world = RowOfThree();
  world.Root(K(9), M(2));
  world.Refuse(MergeMaps{M(1), M(1), {}, K(1), K(1)}, ErrorCode::kInvalidArgument);
  world.Refuse(MergeMaps{M(1), M(2), {}, K(1), K(9)}, ErrorCode::kNotFound);  // attachments swapped
  const Similarity3d huge(1e9, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero());
  world.Refuse(MergeMaps{M(1), M(2), huge, K(9), K(1)}, ErrorCode::kInvalidArgument);
  world.Refuse(FuseLandmarks{L(1), L(1)}, ErrorCode::kInvalidArgument);
  world.Refuse(AddLoopEdge{K(1), K(9), {}}, ErrorCode::kRefused);
  world.Do(MergeMaps{M(1), M(2), {}, K(9), K(1)});
  world.Refuse(MergeMaps{M(1), M(2), {}, K(9), K(1)}, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace pangaea
