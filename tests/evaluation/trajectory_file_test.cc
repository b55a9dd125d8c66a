#include "common/evaluation/trajectory_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

namespace pangaea {
namespace {

using ::testing::HasSubstr;

TEST(TrajectoryFile, PosesReadBackWithExactStamps) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  std::vector<StampedPose> poses;
  std::int64_t stamp = 1403715273262142976;
  for (int i = 0; i < 200; ++i) {
    Vector6d twist;
    for (int k = 0; k < 6; ++k) twist[k] = number(random);
    poses.push_back({stamp += 1 + static_cast<std::int64_t>(random() % 1'000'000'000), Rigid3d::Exp(twist)});
  }
  const auto read = ParseTrajectory(FormatTrajectory(poses), "a.tum");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ((*read)[i].stamp_ns, poses[i].stamp_ns);
    EXPECT_LT(((*read)[i].world_from_body.Inverse() * poses[i].world_from_body).Log().norm(), 1e-8);
  }
}

TEST(TrajectoryFile, ALineHasSecondsWithNineDecimalsPositionAndQuaternion) {
  const std::vector<StampedPose> poses = {{1403715273262142976, Rigid3d(Eigen::Quaterniond::Identity(), {1, 2, 3})}};
  EXPECT_THAT(FormatTrajectory(poses), ::testing::StartsWith("1403715273.262142976 1.000000000 2.000000000 3.0000"));
}

TEST(TrajectoryFile, CommentsBlankLinesAndForeignLineEndingsAreFine) {
  const auto read = ParseTrajectory("# time x y z\r\n\r\n0.5  1 2 3  0 0 0 1\r\n1.5 1 2 3 0 0 0 -1", "a.tum");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), 2U);
  EXPECT_EQ((*read)[1].stamp_ns, 1'500'000'000);
}

TEST(TrajectoryFile, AMalformedLineIsAnErrorWithFileAndLine) {
  const std::string good = "0.5 1 2 3 0 0 0 1\n";
  for (const std::string line :
       {"0.6 1 2 3 0 0 0", "0.6 1 2 3 0 0 0 1 9", "0.6 1 2 nan 0 0 0 1", "0.6 1 2 3 0 0 0 0", "x"}) {
    const auto read = ParseTrajectory(good + line + "\n" + good, "a.tum");
    ASSERT_FALSE(read) << line;
    EXPECT_THAT(read.error().message, HasSubstr("a.tum:2: not a pose")) << line;
  }
  EXPECT_THAT(ReadTrajectory("/does/not/exist.tum").error().message, HasSubstr("/does/not/exist.tum"));
}

TEST(TrajectoryFile, AFolderThatDoesNotExistIsAnError) {
  EXPECT_THAT(WriteTrajectory("/does/not/exist/a.tum", {}).error().message, HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace pangaea
