#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "common/mapping/landmark_visits.h"
#include "tests/estimation/synthetic_world.h"

namespace pangaea::testing {
namespace {

constexpr SessionId kFirst = 7;
constexpr SessionId kSecond = 9;

// Keyframes in a row along x, a hand apart, all looking along z; nothing is seen yet.
WindowBundle Row(SessionId session, std::uint32_t keyframes) {
  WindowBundle bundle;
  bundle.problem.cameras = {StereoCamera()};
  for (std::uint32_t k = 0; k < keyframes; ++k) {
    bundle.keyframes.push_back({session, k + 1});
    const Rigid3d map_from_camera(Eigen::Quaterniond::Identity(), {0.1 * k, 0.0, 0.0});
    bundle.problem.poses.push_back({map_from_camera.Inverse(), 0, k == 0});
  }
  return bundle;
}

// One landmark, seen exactly by these poses.
void AddLandmark(WindowBundle& bundle, const Eigen::Vector3d& point, const std::vector<int>& poses) {
  const int index = static_cast<int>(bundle.problem.points.size());
  bundle.problem.points.push_back({point});
  bundle.landmarks.push_back({kFirst, static_cast<std::uint32_t>(index) + 1});
  for (const int pose : poses) {
    const Eigen::Vector3d seen = bundle.problem.poses[static_cast<std::size_t>(pose)].camera_from_map *
                                 bundle.problem.points.back().point_in_map;
    bundle.problem.observations.push_back({pose, index, Measure(bundle.problem.cameras[0], seen), 2.0});
  }
}

// The poses that see a point of a split problem without and with the larger standard deviation.
struct Seen {
  std::set<int> by;
  std::set<int> tied;
};
Seen SeenBy(const BundleProblem& problem, int point) {
  Seen seen;
  for (const BundleObservation& observation : problem.observations) {
    if (observation.point != point) continue;
    (observation.inverse_sigma == 2.0 ? seen.by : seen.tied).insert(observation.pose);
  }
  return seen;
}

TEST(LandmarkVisits, OneVisitIsTheProblemItself) {
  WindowBundle bundle = Row(kFirst, 20);
  AddLandmark(bundle, {1.0, 0.0, 5.0}, {0, 1, 3, 7, 12});
  const BundleProblem split = SplitByVisits(bundle, {.gap = 6}).problem;
  EXPECT_EQ(split.points.size(), 1U);
  EXPECT_EQ(split.observations.size(), 5U);
  EXPECT_EQ(split.poses.size(), 20U);
}

TEST(LandmarkVisits, AVisitEndsWhereTheLandmarkIsNotSeenForAsLongAsTheGap) {
  WindowBundle bundle = Row(kFirst, 20);
  AddLandmark(bundle, {1.0, 0.0, 5.0}, {0, 1, 7, 8});
  EXPECT_EQ(SplitByVisits(bundle, {.gap = 7}).problem.points.size(), 1U);
  const BundleProblem split = SplitByVisits(bundle, {.gap = 6, .sigma_ratio = 4.0}).problem;
  ASSERT_EQ(split.points.size(), 2U);
  EXPECT_EQ(SeenBy(split, 0).by, (std::set{0, 1}));
  EXPECT_EQ(SeenBy(split, 1).by, (std::set{7, 8}));
  // The nearest views of the two visits are those of keyframes 1 and 7.
  EXPECT_EQ(SeenBy(split, 0).tied, (std::set{7}));
  EXPECT_EQ(SeenBy(split, 1).tied, (std::set{1}));
  for (const BundleObservation& observation : split.observations) {
    const bool tie =
        (observation.pose == 7 && observation.point == 0) || (observation.pose == 1 && observation.point == 1);
    EXPECT_DOUBLE_EQ(observation.inverse_sigma, tie ? 0.5 : 2.0);
  }
}

TEST(LandmarkVisits, EachSessionVisitsByItselfAndIsTiedToTheNearestView) {
  WindowBundle bundle = Row(kFirst, 30);
  // The last five are another session's, in the places of the first one's keyframes 8 to 12.
  for (std::size_t i = 25; i < 30; ++i) {
    bundle.keyframes[i] = {kSecond, static_cast<std::uint32_t>(i) - 24};
    bundle.problem.poses[i].camera_from_map = bundle.problem.poses[i - 17].camera_from_map;
  }
  AddLandmark(bundle, {1.0, 0.0, 5.0}, {0, 1, 2, 8, 24, 25, 26});
  const BundleProblem split = SplitByVisits(bundle, {.gap = 10}).problem;
  ASSERT_EQ(split.points.size(), 3U) << "the first session's two visits, and the second session's";
  EXPECT_EQ(SeenBy(split, 2).by, (std::set{25, 26}));
  EXPECT_EQ(SeenBy(split, 2).tied, (std::set{8}));
}

TEST(LandmarkVisits, OrderOfPosesAndOtherLandmarksDoNotMatter) {
  WindowBundle bundle = Row(kFirst, 20);
  std::reverse(bundle.keyframes.begin(), bundle.keyframes.end());
  std::reverse(bundle.problem.poses.begin(), bundle.problem.poses.end());
  AddLandmark(bundle, {1.0, 0.0, 5.0}, {19, 18, 0});
  AddLandmark(bundle, {0.5, 0.2, 4.0}, {10, 9});
  const BundleProblem split = SplitByVisits(bundle, {.gap = 6}).problem;
  ASSERT_EQ(split.points.size(), 3U);
  EXPECT_EQ(SeenBy(split, 0).by, (std::set{18, 19}));
  EXPECT_EQ(SeenBy(split, 1).by, (std::set{9, 10}));
  EXPECT_EQ(SeenBy(split, 2).by, (std::set{0}));
  EXPECT_EQ(split.points[2].point_in_map, split.points[0].point_in_map);
}

TEST(LandmarkVisits, ALandmarkThatIsFixedIsLeftAsItIs) {
  WindowBundle bundle = Row(kFirst, 20);
  AddLandmark(bundle, {1.0, 0.0, 5.0}, {0, 1, 2, 9});
  bundle.problem.points.front().fixed = true;
  const VisitBundle split = SplitByVisits(bundle, {.gap = 6});
  EXPECT_EQ(split.problem.points.size(), 1U);
  EXPECT_EQ(split.problem.observations.size(), 4U);
  EXPECT_EQ(split.longest_visit, std::vector{-1});
  const auto solved = SolveByVisits(bundle, {.gap = 6}, {});
  ASSERT_TRUE(solved);
  EXPECT_EQ(solved->points, std::vector{bundle.problem.points.front().point_in_map});
}

TEST(LandmarkVisits, ALandmarkComesToLieWhereAllItsVisitsTogetherSeeIt) {
  WindowBundle bundle = Row(kFirst, 20);
  for (BundlePose& pose : bundle.problem.poses) pose.fixed = true;
  AddLandmark(bundle, {1.0, 0.0, 5.0}, {0, 1, 2, 3, 12, 13, 14, 15});
  AddLandmark(bundle, {1.2, 0.0, 5.0}, {4, 5, 6});
  // Half a pixel between the visits, along v; and one observation that contradicts both.
  for (std::size_t i = 4; i < 8; ++i) bundle.problem.observations[i].measurement.y() += 0.5;
  bundle.problem.observations[9].measurement.y() += 20.0;
  const auto solved = SolveByVisits(bundle, {.gap = 6}, {});
  ASSERT_TRUE(solved);
  ASSERT_EQ(solved->points.size(), 2U);
  const double row = bundle.problem.cameras[0].Project(solved->points[0]).y() - bundle.problem.cameras[0].center_y;
  EXPECT_GT(row, 0.1);
  EXPECT_LT(row, 0.4);
  EXPECT_NEAR(solved->points[1].y(), 0.0, 0.01);
  EXPECT_EQ(solved->outliers, (std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0}));
}

TEST(LandmarkVisits, OneViewOnTheFirstVisitSaysNothingOfTheDepthAndSpoilsNoOtherLandmark) {
  WindowBundle bundle = Row(kFirst, 40);
  bundle.problem.cameras = {MonocularCamera()};
  for (BundlePose& pose : bundle.problem.poses) pose.fixed = true;
  // The camera comes back to where it was: the two nearest views have no parallax.
  bundle.problem.poses[20].camera_from_map = bundle.problem.poses[0].camera_from_map;
  const std::vector<Eigen::Vector3d> points = {{1.0, 0.0, 5.0}, {1.5, 0.3, 4.0}};
  AddLandmark(bundle, points[0], {0, 20, 24, 28, 32});
  AddLandmark(bundle, points[1], {0, 4, 8, 24, 28, 32});
  for (BundlePoint& point : bundle.problem.points) point.point_in_map *= 1.3;
  const auto solved = SolveByVisits(bundle, {}, {});
  ASSERT_TRUE(solved);
  EXPECT_LT((solved->points[0] - points[0]).norm(), 0.01);
  EXPECT_LT((solved->points[1] - points[1]).norm(), 0.01);
  EXPECT_EQ(solved->outliers, std::vector<std::uint8_t>(11, 0));
}

// A corridor that is flown through once by each of two sessions. Each finds the corners a little beside where the other
// does, and follows them exactly. The second session's map begins 3 cm off.
struct Corridor {
  explicit Corridor(std::uint64_t seed) {
    Random random(seed);
    constexpr int kKeyframes = 40;
    bundle = Row(kFirst, 2 * kKeyframes);
    for (int k = 0; k < kKeyframes; ++k) {
      const auto again = static_cast<std::size_t>(kKeyframes + k);
      bundle.keyframes[again] = {kSecond, static_cast<std::uint32_t>(k) + 1};
      bundle.problem.poses[again].camera_from_map = bundle.problem.poses[static_cast<std::size_t>(k)].camera_from_map;
    }
    for (int i = 0; i < 400; ++i) {
      const Eigen::Vector3d point(Uniform(random, -1.0, 5.0), Uniform(random, -1.0, 1.0), Uniform(random, 2.0, 4.0));
      std::vector<int> poses;
      for (int k = 0; k < 2 * kKeyframes; ++k) {
        const bool near = std::abs(0.1 * (k % kKeyframes) - point.x()) < 0.4;
        if (near && Uniform(random, 0.0, 1.0) < 0.7) poses.push_back(k);
      }
      const std::size_t begin = bundle.problem.observations.size();
      AddLandmark(bundle, point, poses);
      for (int visit = 0; visit < 2; ++visit) {
        const Eigen::Vector3d beside = Disturbed(random, Eigen::Vector3d::Zero(), 0.5);
        for (std::size_t at = begin; at < bundle.problem.observations.size(); ++at) {
          BundleObservation& seen = bundle.problem.observations[at];
          if ((seen.pose >= kKeyframes) != (visit == 1)) continue;
          seen.measurement =
              Disturbed(random, seen.measurement + Eigen::Vector3d(beside.x(), beside.y(), beside.x()), 0.1);
        }
      }
    }
    truth = bundle.problem.poses;
    for (auto pose = bundle.problem.poses.begin() + kKeyframes; pose != bundle.problem.poses.end(); ++pose) {
      pose->camera_from_map = pose->camera_from_map * Rigid3d(Eigen::Quaterniond::Identity(), {0.0, 0.03, 0.0});
    }
  }

  // Root mean square of the cameras' distance from the truth, metres.
  double Error(const BundleProblem& problem) const {
    BundleOptions options;
    options.solver = BundleSolver::kSparse;
    options.least_noise = 0.1;
    options.iterations = options.iterations_without_outliers = 20;
    const auto result = SolveBundle(problem, options);
    EXPECT_TRUE(result);
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const Eigen::Vector3d center = result->poses[i].Inverse().translation();
      sum += (center - truth[i].camera_from_map.Inverse().translation()).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(truth.size()));
  }

  WindowBundle bundle;
  std::vector<BundlePose> truth;
};

TEST(LandmarkVisits, CamerasLieBetterWhereCornersAreFoundAnewOnEachVisit) {
  double together = 0.0;
  double split = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Corridor corridor(seed);
    together += corridor.Error(corridor.bundle.problem);
    split += corridor.Error(SplitByVisits(corridor.bundle, {}).problem);
  }
  EXPECT_LT(split, 0.8 * together);
  EXPECT_LT(split, 4 * 0.006) << "ties bring the sessions together";
}

TEST(VisitOptions, OutOfRangeIsRefused) {
  EXPECT_TRUE(VisitOptions().Check());
  EXPECT_FALSE(VisitOptions({.gap = 0}).Check());
  EXPECT_FALSE(VisitOptions({.sigma_ratio = 0.5}).Check());
  EXPECT_FALSE(VisitOptions({.sigma_ratio = std::numeric_limits<double>::quiet_NaN()}).Check());
}

}  // namespace
}  // namespace pangaea::testing
