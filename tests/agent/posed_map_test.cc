#include "common/mapping/posed_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/map/consistency.h"
#include "common/map/map_edit.h"
#include "tests/agent/mapping_synthetic_world.h"

namespace pangaea {
namespace {

using testing::CirclePose;
using ::testing::IsEmpty;
using testing::SyntheticWorld;
using testing::SyntheticWorldOptions;

constexpr SessionId kSession = 7;
constexpr int kKeyframes = 24;

// Keyframes of a walk along a part of a circle, each where it truly is.
class PosedWalk {
 public:
  explicit PosedWalk(bool stereo) : world_(Options(stereo)) {
    for (int k = 0; k < kKeyframes; ++k) {
      const Rigid3d camera_from_world = CirclePose(k, 2 * kKeyframes);
      const KeyframeCandidate candidate = world_.NextKeyframe(camera_from_world, Atlas());
      keyframes.push_back({candidate.data, camera_from_world.Inverse()});
      ids_.push_back(candidate.id);
    }
  }

  Atlas Build() const {
    const PosedMap map = BuildPosedMap(kSession, keyframes, {});
    Atlas atlas;
    for (const MapEdit& edit : map.edits) EXPECT_TRUE(Apply(edit, atlas));
    return atlas;
  }
  int PointOf(const Observation& observation) const {
    return world_.points_of(ids_[observation.keyframe.counter - 1])[observation.keypoint];
  }
  // Of the landmarks that several keyframes see: how many, and which part of their observations shows another corner
  // than the first one does; and the median distance from that corner, metres.
  struct Quality {
    std::size_t shared = 0;
    double wrong = 0.0;
    double median_error = 0.0;
  };
  Quality Judge(const Atlas& atlas) const {
    Quality quality;
    std::size_t observations = 0;
    std::size_t wrong = 0;
    std::vector<double> errors;
    const Rigid3d& world_from_map = keyframes.front().world_from_camera;
    atlas.ForEachLandmark([&](const Landmark& landmark) {
      if (landmark.observations.size() < 2) return;
      const int point = PointOf(landmark.observations.front());
      for (const Observation& observation : landmark.observations) wrong += PointOf(observation) == point ? 0 : 1;
      observations += landmark.observations.size();
      errors.push_back((world_from_map * landmark.point_in_map - world_.point(point).position).norm());
    });
    quality.shared = errors.size();
    if (errors.empty()) return quality;
    quality.wrong = static_cast<double>(wrong) / static_cast<double>(observations);
    std::ranges::nth_element(errors, errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2));
    quality.median_error = errors[errors.size() / 2];
    return quality;
  }

  std::vector<PosedKeyframe> keyframes;

 private:
  static SyntheticWorldOptions Options(bool stereo) {
    SyntheticWorldOptions options;
    options.stereo = stereo;
    return options;
  }

  SyntheticWorld world_;
  std::vector<KeyframeId> ids_;
};

class PosedMapOf : public ::testing::TestWithParam<bool> {};

TEST_P(PosedMapOf, KeyframesOfARoomHasItsCornersWhereTheyAre) {
  const PosedWalk walk(GetParam());
  const Atlas atlas = walk.Build();
  EXPECT_THAT(CheckConsistency(atlas), IsEmpty());
  EXPECT_EQ(atlas.keyframe_count(), static_cast<std::size_t>(kKeyframes));
  const PosedWalk::Quality quality = walk.Judge(atlas);
  EXPECT_GT(quality.shared, 800U);
  EXPECT_LT(quality.wrong, 0.01);
  EXPECT_LT(quality.median_error, 0.03);
}

TEST_P(PosedMapOf, KeyframesLeavesThemWhereTheyAre) {
  const PosedWalk walk(GetParam());
  const Atlas atlas = walk.Build();
  for (std::uint32_t i = 0; i < kKeyframes; ++i) {
    const Rigid3d map_from_camera =
        walk.keyframes.front().world_from_camera.Inverse() * walk.keyframes[i].world_from_camera;
    const Keyframe& keyframe = *atlas.FindKeyframe({kSession, i + 1});
    EXPECT_LT((keyframe.camera_from_map * map_from_camera).Log().norm(), 1e-9);
  }
}

TEST_P(PosedMapOf, KeyframesInTheWrongPlacesSharesLittle) {
  PosedWalk walk(GetParam());
  std::mt19937_64 random(1);
  std::vector<Rigid3d> poses;
  for (const PosedKeyframe& keyframe : walk.keyframes) poses.push_back(keyframe.world_from_camera);
  std::ranges::shuffle(poses, random);
  const std::size_t right = walk.Judge(walk.Build()).shared;
  for (std::size_t i = 0; i < poses.size(); ++i) walk.keyframes[i].world_from_camera = poses[i];
  EXPECT_LT(walk.Judge(walk.Build()).shared, right / 3);  // some lie on the line by chance
}

TEST_P(PosedMapOf, TheSameKeyframesIsTheSame) {
  const PosedWalk walk(GetParam());
  const PosedMap a = BuildPosedMap(kSession, walk.keyframes, {});
  const PosedMap b = BuildPosedMap(kSession, walk.keyframes, {});
  EXPECT_EQ(EncodeEdits(a.edits), EncodeEdits(b.edits));
  EXPECT_GT(a.median_error, 0.1);  // the noise of the synthetic keypoints
  EXPECT_LT(a.median_error, 1.0);
}

INSTANTIATE_TEST_SUITE_P(MonocularAndStereo, PosedMapOf, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "Stereo" : "Monocular"; });

TEST(PosedMapOptions, AValueOutOfRangeIsNamed) {
  EXPECT_TRUE(PosedMapOptions().Check());
  PosedMapOptions options;
  options.min_overlap = 2.0;
  const Status status = options.Check();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, ::testing::HasSubstr("min_overlap"));
}

}  // namespace
}  // namespace pangaea
