#include "common/geometry/horn.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace pangaea {
namespace {

using Points = std::vector<Eigen::Vector3d>;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  Eigen::Vector3d Vector(double size) {
    std::uniform_real_distribution<double> uniform(-size, size);
    const double x = uniform(engine_);
    const double y = uniform(engine_);
    return {x, y, uniform(engine_)};
  }

 private:
  std::mt19937_64 engine_;
};

Similarity3d RandomSimilarity(Random& random, bool with_scale) {
  const double scale = with_scale ? std::exp(random.Vector(1.5).x()) : 1.0;
  return Similarity3d{scale, ExpSo3(random.Vector(1.8)), random.Vector(10.0)};  // braces draw in order
}

TEST(AlignPoints, RecoversTheSimilarityOfExactPoints) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    for (const bool with_scale : {false, true}) {
      Random random(seed);
      const Similarity3d truth = RandomSimilarity(random, with_scale);
      Points source, target;
      for (int i = 0; i < 3 + static_cast<int>(seed % 20); ++i) {
        source.push_back(random.Vector(5.0));
        target.push_back(truth * source.back());
      }
      const auto result = AlignPoints(target, source, with_scale);
      ASSERT_TRUE(result) << "seed " << seed;
      EXPECT_NEAR(result->scale(), truth.scale(), 1e-9 * truth.scale());
      for (const Eigen::Vector3d& point : source) EXPECT_LT((*result * point - truth * point).norm(), 1e-8);
    }
  }
}

TEST(AlignPoints, NoNeighbouringTransformFitsNoisyPointsBetter) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const Similarity3d truth = RandomSimilarity(random, true);
    Points source, target;
    for (int i = 0; i < 20; ++i) {
      source.push_back(random.Vector(5.0));
      target.push_back(truth * source.back() + random.Vector(0.3));
    }
    const auto error = [&](const Similarity3d& transform) {
      double sum = 0.0;
      for (std::size_t i = 0; i < source.size(); ++i) sum += (target[i] - transform * source[i]).squaredNorm();
      return sum;
    };
    const auto result = AlignPoints(target, source, true);
    ASSERT_TRUE(result);
    for (int k = 0; k < 7; ++k) {
      for (const double h : {-1e-4, 1e-4}) {
        Vector6d twist = Vector6d::Zero();
        if (k < 6) twist(k) = h;
        const Similarity3d nudge(Rigid3d::Exp(twist));
        const Similarity3d scaled(k == 6 ? 1.0 + h : 1.0, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero());
        EXPECT_GE(error(nudge * *result * scaled), error(*result)) << "seed " << seed << " k " << k;
      }
    }
  }
}

TEST(AlignPoints, AMirroredCloudStillGivesARotation) {
  Random random(3);
  Points source, target;
  for (int i = 0; i < 10; ++i) {
    source.push_back(random.Vector(2.0));
    target.push_back(Eigen::Vector3d(-source.back().x(), source.back().y(), source.back().z()));
  }
  const auto result = AlignPoints(target, source, false);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->rotation().toRotationMatrix().determinant(), 1.0, 1e-12);
}

TEST(AlignPoints, DegenerateCloudsHaveNoAlignment) {
  const Points two = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  EXPECT_FALSE(AlignPoints(two, two, true));
  Points line, same;
  for (int i = 0; i < 10; ++i) {
    line.push_back(Eigen::Vector3d(1.0, 2.0, 3.0) * i);
    same.push_back(Eigen::Vector3d(1.0, 2.0, 3.0));
  }
  EXPECT_FALSE(AlignPoints(line, line, true));
  EXPECT_FALSE(AlignPoints(same, same, false));
  EXPECT_FALSE(AlignPoints({}, {}, false));
  Points broken = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
  const Points intact = broken;
  broken[1].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(AlignPoints(intact, broken, true));
}

}  // namespace
}  // namespace pangaea
