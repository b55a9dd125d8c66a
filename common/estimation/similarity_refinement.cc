#include "common/estimation/similarity_refinement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/check.h"
#include "common/estimation/similarity_kernel.h"

namespace pangaea {
namespace {

// Levenberg-Marquardt damping, relative to the diagonal of the information.
constexpr double kInitialDamping = 1e-6;
constexpr double kDampingGrowth = 10.0;
constexpr double kDampingDecay = 0.1;
constexpr double kMaxDamping = 1e6;
// The smallest pivot of the information, scaled to a unit diagonal, of a motion that is determined.
constexpr double kMinPivot = 1e-9;
// Squared errors, in sigmas, beyond which a pair is none at the first guess already. A kernel tames an error, but not
// the steep slope of a point that comes to lie close to the camera's plane.
constexpr double kGrossError = 1e4;

double ErrorOf(const Sighting& sighting, const Eigen::Vector3d& point) {
  const Eigen::Vector3d point_in_camera = sighting.camera_from_side * point;
  if (!(point_in_camera.z() > kMinDepth)) return std::numeric_limits<double>::infinity();
  return sighting.inverse_sigma * sighting.inverse_sigma *
         ReprojectionError(sighting.camera, point_in_camera, sighting.measurement).squaredNorm();
}

class Refiner {
 public:
  Refiner(std::span<const SightingPair> pairs, const Similarity3d& initial, const SimilarityRefinementOptions& options,
          std::span<std::uint8_t> inliers)
      : pairs_(pairs), options_(options), inliers_(inliers), target_from_source_(initial) {}

  std::optional<RefinedSimilarity> Run() {
    DropGrossErrors();
    for (int round = 0; round < options_.rounds; ++round) {
      if (Count() < options_.min_inliers || !Optimize()) return std::nullopt;
      if (!Judge()) break;
    }
    if (Count() < options_.min_inliers) return std::nullopt;
    return Report();
  }

 private:
  std::size_t Count() const {
    return static_cast<std::size_t>(std::ranges::count_if(inliers_, [](std::uint8_t flag) { return flag != 0; }));
  }

  void DropGrossErrors() {
    const Similarity3d source_from_target = target_from_source_.Inverse();
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const PairErrors errors = ErrorsOf(pairs_[i], target_from_source_, source_from_target);
      const bool usable = errors.in_target <= kGrossError && errors.in_source <= kGrossError;  // false for NaN
      if (!usable) inliers_[i] = 0;
    }
  }

  SimilarityNormalEquations Linearize(const Similarity3d& target_from_source, bool robust) const {
    const double none = std::numeric_limits<double>::infinity();
    SimilarityNormalEquations equations =
        AccumulateSimilarity(pairs_, inliers_, target_from_source, robust ? options_.monocular_chi2 : none,
                             robust ? options_.stereo_chi2 : none);
    if (!options_.with_scale) {
      equations.gradient(6) = 0.0;
      equations.information.row(6).setZero();
      equations.information.col(6).setZero();
    }
    return equations;
  }

  // The system of a step; without scale a unit equation leaves the scale alone.
  Matrix7d Solvable(const Matrix7d& information) const {
    Matrix7d system = information;
    if (!options_.with_scale) system(6, 6) = 1.0;
    return system;
  }

  bool IsDetermined(const Matrix7d& information) const {
    const Matrix7d system = Solvable(information);
    const Vector7d diagonal = system.diagonal();
    if (!system.allFinite() || !(diagonal.array() > 0.0).all()) return false;
    const Vector7d scale = diagonal.cwiseSqrt().cwiseInverse();
    const Eigen::LDLT<Matrix7d> factor(scale.asDiagonal() * system * scale.asDiagonal());
    return factor.info() == Eigen::Success && factor.vectorD().minCoeff() > kMinPivot;
  }

  // Moves to the minimum over the current inliers. False where they do not determine a motion.
  bool Optimize() {
    double damping = kInitialDamping;
    SimilarityNormalEquations equations = Linearize(target_from_source_, true);
    for (int i = 0; i < options_.max_iterations && damping < kMaxDamping; ++i) {
      if (!IsDetermined(equations.information)) return false;
      Matrix7d damped = Solvable(equations.information);
      damped.diagonal() *= 1.0 + damping;
      const Vector7d step = -damped.ldlt().solve(equations.gradient);
      if (!step.allFinite()) return false;
      const bool small = -step.dot(equations.gradient) < options_.step_tolerance * options_.step_tolerance;
      const Similarity3d trial = Perturb(step, target_from_source_);
      const SimilarityNormalEquations next = Linearize(trial, true);
      if (next.cost < equations.cost) {
        target_from_source_ = trial;
        equations = next;
        damping *= kDampingDecay;
      } else {
        damping *= kDampingGrowth;
      }
      if (small) break;
    }
    return true;
  }

  // Sets every pair's flag; whether any changed.
  bool Judge() {
    bool changed = false;
    squared_error_ = 0.0;
    const Similarity3d source_from_target = target_from_source_.Inverse();
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const PairErrors errors = ErrorsOf(pairs_[i], target_from_source_, source_from_target);
      const bool fits = errors.in_target <= LimitOf(pairs_[i].target) && errors.in_source <= LimitOf(pairs_[i].source);
      const std::uint8_t flag = fits ? 1 : 0;
      changed = changed || flag != inliers_[i];
      inliers_[i] = flag;
      if (fits) squared_error_ += errors.in_target + errors.in_source;
    }
    return changed;
  }

  double LimitOf(const Sighting& sighting) const {
    return IsStereo(sighting.measurement) ? options_.stereo_chi2 : options_.monocular_chi2;
  }

  std::optional<RefinedSimilarity> Report() const {
    RefinedSimilarity result;
    result.target_from_source = target_from_source_;
    result.inliers = Count();
    result.mean_squared_error = squared_error_ / (2.0 * static_cast<double>(result.inliers));
    result.information = Linearize(target_from_source_, false).information;
    if (!IsDetermined(result.information)) return std::nullopt;
    return result;
  }

  std::span<const SightingPair> pairs_;
  const SimilarityRefinementOptions& options_;
  std::span<std::uint8_t> inliers_;
  Similarity3d target_from_source_;
  double squared_error_ = 0.0;
};

}  // namespace

Status SimilarityRefinementOptions::Check() const {
  if (!(monocular_chi2 > 0.0) || !(stereo_chi2 > 0.0) || !(step_tolerance >= 0.0)) {
    return Fail(ErrorCode::kInvalidArgument,
                "similarity refinement: chi2 thresholds must be > 0 and step_tolerance >= 0");
  }
  if (rounds < 1 || max_iterations < 1) {
    return Fail(ErrorCode::kInvalidArgument, "similarity refinement: rounds and max_iterations must be >= 1");
  }
  if (min_inliers < 3) return Fail(ErrorCode::kInvalidArgument, "similarity refinement: min_inliers must be >= 3");
  return {};
}

PairErrors ErrorsOf(const SightingPair& pair, const Similarity3d& target_from_source,
                    const Similarity3d& source_from_target) {
  return {ErrorOf(pair.target, target_from_source * pair.source.point),
          ErrorOf(pair.source, source_from_target * pair.target.point)};
}

Similarity3d Perturb(const Vector7d& e, const Similarity3d& target_from_source) {
  return Similarity3d(std::exp(e(6)), ExpSo3(e.segment<3>(3)), e.head<3>()) * target_from_source;
}

std::optional<RefinedSimilarity> RefineSimilarity(std::span<const SightingPair> pairs, const Similarity3d& initial,
                                                  const SimilarityRefinementOptions& options,
                                                  std::span<std::uint8_t> inliers) {
  PANGAEA_CHECK(inliers.size() == pairs.size());
  std::optional<RefinedSimilarity> refined;
  if (initial.AllFinite()) refined = Refiner(pairs, initial, options, inliers).Run();
  if (!refined) std::ranges::fill(inliers, std::uint8_t{0});
  return refined;
}

}  // namespace pangaea
