#include "common/estimation/two_view_models.h"

#include <Eigen/LU>
#include <array>
#include <utility>

#include "common/geometry/essential_matrix.h"
#include "common/geometry/five_point.h"
#include "common/geometry/homography.h"
#include "common/geometry/ransac.h"
#include "common/geometry/reprojection.h"

namespace pangaea {
namespace {

// 95 % quantile of chi-squared with one degree of freedom: the distance from an epipolar line.
constexpr double kLineChi2 = 3.841;
// Gamma of Mur-Artal et al. 2015, equation (2): the same for both models, so that their scores compare.
constexpr double kGamma = kMonocularChi2;

Eigen::Matrix3d PixelFromRay(const IdealCamera& camera) {
  Eigen::Matrix3d matrix;
  matrix << camera.focal_x, 0.0, camera.center_x, 0.0, camera.focal_y, camera.center_y, 0.0, 0.0, 1.0;
  return matrix;
}

// Squared distance between where a homography takes a point and where it was seen, pixels.
double TransferError(const Eigen::Matrix3d& homography, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector3d taken = homography * from.homogeneous();
  return (taken.hnormalized() - to).squaredNorm();
}

// Squared distance of a point from a line, pixels.
double LineDistance(const Eigen::Vector3d& line, const Eigen::Vector2d& point) {
  const double offset = line.dot(point.homogeneous());
  return offset * offset / line.head<2>().squaredNorm();
}

// Of squared transfer errors: both pixels are noisy, so that their difference has twice the variance.
double TransferWeight(const PixelMatch& match) { return 0.5 * match.inverse_sigma * match.inverse_sigma; }

// Local optimisation fits to ever closer inliers (Chum et al. 2003): from a noisy minimal sample the true ones are
// still far. Factors of the squared threshold.
constexpr std::array kLooseness{9.0, 3.0, 1.0};

// Adds both transfer errors of a match, each cut off at `limit` (equation (2)); true where both are within it.
bool Count(double first_error, double second_error, double limit, double& score) {
  const bool first_fits = first_error < limit;  // false for NaN
  const bool second_fits = second_error < limit;
  if (first_fits) score += kGamma - first_error;
  if (second_fits) score += kGamma - second_error;
  return first_fits && second_fits;
}

class HomographyJudge {
 public:
  static constexpr std::size_t kSampleSize = 4;
  explicit HomographyJudge(const IdealCamera& camera)
      : pixel_from_ray_(PixelFromRay(camera)), ray_from_pixel_(pixel_from_ray_.inverse()) {}

  static void Solve(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second,
                    std::vector<Eigen::Matrix3d>& models) {
    if (const auto model = Fit(first, second)) models.push_back(*model);
  }
  static std::optional<Eigen::Matrix3d> Fit(std::span<const Eigen::Vector2d> first,
                                            std::span<const Eigen::Vector2d> second) {
    return FitHomography(first, second);
  }
  // Flags the matches within `looseness` times the squared threshold; the score means something for 1 alone.
  double Score(const Eigen::Matrix3d& matrix, std::span<const PixelMatch> matches, double looseness,
               std::span<std::uint8_t> inliers) const {
    const Eigen::Matrix3d second_from_first = pixel_from_ray_ * matrix * ray_from_pixel_;
    const Eigen::Matrix3d first_from_second = second_from_first.inverse();
    double score = 0.0;
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const PixelMatch& match = matches[i];
      const double weight = TransferWeight(match) / looseness;
      const double in_second = weight * TransferError(second_from_first, match.first, match.second);
      const double in_first = weight * TransferError(first_from_second, match.second, match.first);
      inliers[i] = Count(in_first, in_second, kMonocularChi2, score) ? 1 : 0;
    }
    return score;
  }

 private:
  Eigen::Matrix3d pixel_from_ray_;
  Eigen::Matrix3d ray_from_pixel_;
};

class EssentialJudge {
 public:
  static constexpr std::size_t kSampleSize = 5;
  explicit EssentialJudge(const IdealCamera& camera) : ray_from_pixel_(PixelFromRay(camera).inverse()) {}

  static void Solve(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second,
                    std::vector<Eigen::Matrix3d>& models) {
    models = SolveFivePoint(first, second);
  }
  static std::optional<Eigen::Matrix3d> Fit(std::span<const Eigen::Vector2d> first,
                                            std::span<const Eigen::Vector2d> second) {
    return FitEssentialMatrix(first, second);
  }
  // Flags the matches within `looseness` times the squared threshold; the score means something for 1 alone.
  double Score(const Eigen::Matrix3d& matrix, std::span<const PixelMatch> matches, double looseness,
               std::span<std::uint8_t> inliers) const {
    const Eigen::Matrix3d fundamental = ray_from_pixel_.transpose() * matrix * ray_from_pixel_;
    double score = 0.0;
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const PixelMatch& match = matches[i];
      const double weight = TransferWeight(match) / looseness;
      const double in_second = weight * LineDistance(fundamental * match.first.homogeneous(), match.second);
      const double in_first = weight * LineDistance(fundamental.transpose() * match.second.homogeneous(), match.first);
      inliers[i] = Count(in_first, in_second, kLineChi2, score) ? 1 : 0;
    }
    return score;
  }

 private:
  Eigen::Matrix3d ray_from_pixel_;
};

// RANSAC over one kind of model.
template <typename Judge>
class Search {
 public:
  Search(const IdealCamera& camera, std::span<const PixelMatch> matches) : judge_(camera), matches_(matches) {
    for (const PixelMatch& match : matches) {
      rays_.first.push_back(camera.Unproject(match.first).head<2>());
      rays_.second.push_back(camera.Unproject(match.second).head<2>());
    }
  }

  std::optional<TwoViewModel> Run(const TwoViewRansacOptions& options, std::uint64_t seed) const {
    const RansacOptions ransac{.sample_size = Judge::kSampleSize,
                               .max_iterations = options.max_iterations,
                               .min_iterations = options.min_iterations,
                               .confidence = options.confidence};
    auto best = Ransac<Eigen::Matrix3d>(
        matches_.size(), ransac, seed,
        [&](std::span<const std::size_t> sample, std::vector<Eigen::Matrix3d>& models) {
          const auto [first, second] = Select(sample);
          Judge::Solve(first, second, models);
        },
        [&](const Eigen::Matrix3d& model, std::span<std::uint8_t> inliers) { return Cost(model, inliers); },
        [&](const Eigen::Matrix3d& model, std::span<const std::uint8_t>) { return Improve(model); });
    if (!best) return std::nullopt;
    return TwoViewModel{best->model, -best->score.cost, std::move(best->inliers)};
  }

 private:
  RansacScore Cost(const Eigen::Matrix3d& model, std::span<std::uint8_t> inliers) const {
    RansacScore score{-judge_.Score(model, matches_, 1.0, inliers), 0};
    for (const std::uint8_t flag : inliers) score.inliers += flag;
    return score;
  }

  std::optional<Eigen::Matrix3d> Improve(Eigen::Matrix3d model) const {
    std::vector<std::uint8_t> inliers(matches_.size());
    for (const double looseness : kLooseness) {
      judge_.Score(model, matches_, looseness, inliers);
      const auto [first, second] = Select(IndicesOf(inliers));
      const auto fitted = Judge::Fit(first, second);
      if (!fitted) return std::nullopt;
      model = *fitted;
    }
    return model;
  }

  struct Rays {
    std::vector<Eigen::Vector2d> first;
    std::vector<Eigen::Vector2d> second;
  };
  Rays Select(std::span<const std::size_t> indices) const {
    Rays selected;
    for (const std::size_t i : indices) {
      selected.first.push_back(rays_.first[i]);
      selected.second.push_back(rays_.second[i]);
    }
    return selected;
  }

  static std::vector<std::size_t> IndicesOf(std::span<const std::uint8_t> inliers) {
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < inliers.size(); ++i) {
      if (inliers[i] != 0) indices.push_back(i);
    }
    return indices;
  }

  Judge judge_;
  std::span<const PixelMatch> matches_;
  Rays rays_;  // of the matches, at z = 1
};

}  // namespace

std::optional<TwoViewModel> FindHomography(const IdealCamera& camera, std::span<const PixelMatch> matches,
                                           const TwoViewRansacOptions& options, std::uint64_t seed) {
  return Search<HomographyJudge>(camera, matches).Run(options, seed);
}

std::optional<TwoViewModel> FindEssentialMatrix(const IdealCamera& camera, std::span<const PixelMatch> matches,
                                                const TwoViewRansacOptions& options, std::uint64_t seed) {
  return Search<EssentialJudge>(camera, matches).Run(options, seed);
}

std::vector<std::uint8_t> EpipolarInliers(const IdealCamera& camera, std::span<const PixelMatch> matches,
                                          const Rigid3d& second_from_first) {
  const Eigen::Matrix3d essential =
      Skew(second_from_first.translation()) * second_from_first.rotation().toRotationMatrix();
  std::vector<std::uint8_t> inliers(matches.size());
  EssentialJudge(camera).Score(essential, matches, 1.0, inliers);
  return inliers;
}

}  // namespace pangaea
