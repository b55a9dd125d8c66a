#include "common/estimation/two_view_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "common/base/check.h"
#include "common/base/median.h"
#include "common/estimation/bundle_adjustment.h"
#include "common/geometry/essential_matrix.h"
#include "common/geometry/homography.h"
#include "common/geometry/triangulation.h"

namespace pangaea {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
// With fewer no model is worth looking for.
constexpr int kMinMatches = 16;

// A motion may be judged by points of this share of the least parallax: enough to tell front from behind.
constexpr double kJudgedParallax = 0.5;

// Degrees between two directions of motion that count as the same one.
constexpr double kSameDirection = 20.0;

// Of the matches beside a plane that decide for one motion, another may explain at most this share: by chance, and
// what is so close to the plane that it tells little.
constexpr double kMaxRivalShare = 0.5;

// Times that a motion is adjusted to the matches that it explains by then.
constexpr int kAdjustments = 8;

// What the result is rounded to, in median depths and as part of a turn: a hundredth of a pixel. Samples of the matches
// that lead to one optimum mostly give one start then, to the bit.
constexpr double kGrain = 1.0 / (1 << 16);

double Rounded(double value) { return kGrain * std::round(value / kGrain); }
Eigen::Vector3d Rounded(const Eigen::Vector3d& vector) {
  return {Rounded(vector.x()), Rounded(vector.y()), Rounded(vector.z())};
}

// A motion and the points that it explains.
struct Hypothesis {
  Rigid3d second_from_first;
  std::vector<TwoViewPoint> points;  // with enough parallax to have a depth
  std::size_t explained = 0;         // those, and others by which motions are told apart
};

// Degrees.
double Parallax(const Rigid3d& second_from_first, const Eigen::Vector3d& point_in_first) {
  return kDegrees * ParallaxAngle(point_in_first, point_in_first - second_from_first.Inverse().translation());
}

bool Fits(const IdealCamera& camera, const Eigen::Vector3d& point_in_camera, const Eigen::Vector2d& pixel,
          double inverse_sigma) {
  if (point_in_camera.z() <= kMinDepth) return false;
  const double error = inverse_sigma * inverse_sigma * (camera.Project(point_in_camera) - pixel).squaredNorm();
  return error <= kMonocularChi2;
}

class Reconstructor {
 public:
  Reconstructor(const IdealCamera& camera, std::span<const PixelMatch> matches, const TwoViewOptions& options)
      : camera_(camera), matches_(matches), options_(options) {
    const auto share = static_cast<std::size_t>(options.min_point_share * static_cast<double>(matches.size()));
    min_points_ = std::max(static_cast<std::size_t>(options.min_points), share);
  }

  tl::expected<TwoViewReconstruction, TwoViewRefusal> Run(std::uint64_t seed) const {
    if (matches_.size() < min_points_) return tl::make_unexpected(TwoViewRefusal::kTooFewMatches);
    const auto homography = FindHomography(camera_, matches_, options_.ransac, seed);
    const auto essential = FindEssentialMatrix(camera_, matches_, options_.ransac, seed + 1);
    const double homography_score = homography ? homography->score : 0.0;
    const double essential_score = essential ? essential->score : 0.0;
    if (!(homography_score + essential_score > 0.0)) return tl::make_unexpected(TwoViewRefusal::kNoModel);
    const bool planar = homography_score > options_.homography_ratio * (homography_score + essential_score);
    const auto of_plane = Choose(homography, DecomposeHomography);
    const auto of_depth = Choose(essential, DecomposeEssentialMatrix);
    const bool has_depth = !planar || (of_depth && IsDecidedBesidePlane(*homography, *essential, *of_depth));
    const auto& best = has_depth ? of_depth : of_plane;
    if (!best) return tl::make_unexpected(best.error());
    // With little depth in the scene each of the two may have found the mirrored motion.
    if (!has_depth && of_depth && !Agree(*of_plane, *of_depth)) return tl::make_unexpected(TwoViewRefusal::kAmbiguous);
    return Adjust(*best, planar);
  }

 private:
  template <typename Decompose>
  tl::expected<Hypothesis, TwoViewRefusal> Choose(const std::optional<TwoViewModel>& model,
                                                  const Decompose& decompose) const {
    if (!model) return tl::make_unexpected(TwoViewRefusal::kNoModel);
    return ChooseMotion(decompose(model->matrix), model->inliers);
  }

  // A plane leaves two motions possible, but what stands before or behind it fits only the true one. Whether enough of
  // it is seen to decide for the motion of the essential matrix, which then must be one of the two: along a plane
  // alone an essential matrix may show any motion.
  bool IsDecidedBesidePlane(const TwoViewModel& homography, const TwoViewModel& essential,
                            const Hypothesis& of_depth) const {
    std::vector<std::uint8_t> beside = essential.inliers;
    for (std::size_t i = 0; i < beside.size(); ++i) {
      if (homography.inliers[i] != 0) beside[i] = 0;
    }
    const auto explained = [&](const Rigid3d& motion) {
      return static_cast<double>(Triangulate(motion, beside).explained);
    };
    const double decisive = explained(of_depth.second_from_first);
    const double share = options_.min_beside_plane_share * static_cast<double>(matches_.size());
    if (decisive < std::max(static_cast<double>(options_.min_beside_plane), share)) return false;
    bool is_of_plane = false;
    for (const Rigid3d& motion : DecomposeHomography(homography.matrix)) {
      if (HaveSameDirection(motion, of_depth.second_from_first)) {
        is_of_plane = true;
      } else if (explained(motion) > kMaxRivalShare * decisive) {
        return false;
      }
    }
    return is_of_plane;
  }

  static bool HaveSameDirection(const Rigid3d& a, const Rigid3d& b) {
    return kDegrees * ParallaxAngle(a.Inverse().translation(), b.Inverse().translation()) <= kSameDirection;
  }

  bool Agree(const Hypothesis& a, const Hypothesis& b) const {
    return HaveSameDirection(a.second_from_first, b.second_from_first) ||
           static_cast<double>(b.explained) < options_.max_runner_up * static_cast<double>(a.explained);
  }

  tl::expected<Hypothesis, TwoViewRefusal> ChooseMotion(const std::vector<Rigid3d>& motions,
                                                        const std::vector<std::uint8_t>& inliers) const {
    if (static_cast<std::size_t>(std::count(inliers.begin(), inliers.end(), 1)) < min_points_) {
      return tl::make_unexpected(TwoViewRefusal::kNoModel);
    }
    Hypothesis best;
    std::size_t runner_up = 0;
    for (const Rigid3d& motion : motions) {
      Hypothesis hypothesis = Triangulate(motion, inliers);
      if (hypothesis.explained > best.explained) std::swap(hypothesis, best);
      runner_up = std::max(runner_up, hypothesis.explained);
    }
    if (best.points.size() < min_points_) return tl::make_unexpected(TwoViewRefusal::kLowParallax);
    if (static_cast<double>(runner_up) > options_.max_runner_up * static_cast<double>(best.explained)) {
      return tl::make_unexpected(TwoViewRefusal::kAmbiguous);
    }
    return best;
  }

  Hypothesis Triangulate(const Rigid3d& second_from_first, const std::vector<std::uint8_t>& inliers) const {
    Hypothesis hypothesis{second_from_first, {}, 0};
    for (std::uint32_t i = 0; i < matches_.size(); ++i) {
      const PixelMatch& match = matches_[i];
      if (inliers[i] == 0) continue;
      const Ray first = PixelRay(camera_, Rigid3d(), match.first);
      const Ray second = PixelRay(camera_, second_from_first, match.second);
      const auto point = TriangulateMidpoint(first, second, kJudgedParallax * options_.min_parallax / kDegrees);
      if (!point || !Fits(camera_, *point, match.first, match.inverse_sigma)) continue;
      if (!Fits(camera_, second_from_first * *point, match.second, match.inverse_sigma)) continue;
      ++hypothesis.explained;
      if (Parallax(second_from_first, *point) >= options_.min_parallax) hypothesis.points.push_back({i, *point});
    }
    return hypothesis;
  }

  // To all that the adjusted motion explains in turn, until that is what it was adjusted to: which sample found the
  // motion matters no longer, as a rule.
  tl::expected<TwoViewReconstruction, TwoViewRefusal> Adjust(Hypothesis hypothesis, bool planar) const {
    const std::vector<std::uint8_t> all(matches_.size(), 1);
    TwoViewReconstruction result;
    for (int i = 0; i < kAdjustments; ++i) {
      result = AdjustOnce(hypothesis);
      Hypothesis next = Triangulate(result.second_from_first, all);
      if (std::ranges::equal(next.points, hypothesis.points, {}, &TwoViewPoint::match, &TwoViewPoint::match)) break;
      hypothesis = std::move(next);
    }
    // A point may lie between two rays that pass each other: as strict as where the motion was sought.
    const std::vector<std::uint8_t> inliers = EpipolarInliers(camera_, matches_, result.second_from_first);
    std::erase_if(result.points, [&](const TwoViewPoint& point) { return inliers[point.match] == 0; });
    result.planar = planar;
    return Finish(std::move(result));
  }

  TwoViewReconstruction AdjustOnce(const Hypothesis& hypothesis) const {
    BundleProblem problem;
    problem.cameras.push_back(camera_);
    problem.poses = {{Rigid3d(), 0, true}, {hypothesis.second_from_first, 0, false}};
    for (const TwoViewPoint& point : hypothesis.points) {
      const int index = static_cast<int>(problem.points.size());
      const PixelMatch& match = matches_[point.match];
      problem.points.push_back({point.point_in_first, false});
      problem.observations.push_back({0, index, {match.first.x(), match.first.y(), -1.0}, match.inverse_sigma});
      problem.observations.push_back({1, index, {match.second.x(), match.second.y(), -1.0}, match.inverse_sigma});
    }
    BundleOptions options;
    options.cost_tolerance = 0.0;  // to the last digit
    options.iterations = options_.iterations;
    options.iterations_without_outliers = options_.iterations_without_outliers;
    options.narrow_share = std::numeric_limits<double>::infinity();
    const auto adjusted = SolveBundle(problem, options);
    PANGAEA_CHECK(adjusted.has_value());
    TwoViewReconstruction result;
    result.second_from_first = adjusted->poses[1];
    for (std::size_t i = 0; i < hypothesis.points.size(); ++i) {
      const bool outlier = adjusted->outliers[2 * i] != 0 || adjusted->outliers[2 * i + 1] != 0;
      const double parallax = Parallax(result.second_from_first, adjusted->points[i]);
      if (outlier || parallax < options_.min_parallax) continue;
      result.points.push_back({hypothesis.points[i].match, adjusted->points[i]});
    }
    return result;
  }

  // Judges what is left and gives it its scale.
  tl::expected<TwoViewReconstruction, TwoViewRefusal> Finish(TwoViewReconstruction result) const {
    if (result.points.size() < min_points_) return tl::make_unexpected(TwoViewRefusal::kLowParallax);
    std::vector<double> depths;
    std::vector<double> parallaxes;
    for (const TwoViewPoint& point : result.points) {
      depths.push_back(point.point_in_first.z());
      parallaxes.push_back(Parallax(result.second_from_first, point.point_in_first));
    }
    const double scale = 1.0 / Median(std::move(depths));
    result.median_parallax = Median(std::move(parallaxes));
    const Rigid3d& motion = result.second_from_first;
    const Eigen::Vector4d turn = motion.rotation().coeffs().unaryExpr([](double part) { return Rounded(part); });
    result.second_from_first = Rigid3d(Eigen::Quaterniond(turn).normalized(), Rounded(scale * motion.translation()));
    for (TwoViewPoint& point : result.points) point.point_in_first = Rounded(scale * point.point_in_first);
    return result;
  }

  const IdealCamera& camera_;
  std::span<const PixelMatch> matches_;
  const TwoViewOptions& options_;
  std::size_t min_points_ = 0;
};

}  // namespace

Status TwoViewOptions::Check() const {
  const auto refuse = [](const char* what) {
    return Fail(ErrorCode::kInvalidArgument, std::string("two views: ") + what);
  };
  if (ransac.min_iterations < 1 || ransac.max_iterations < ransac.min_iterations)
    return refuse("ransac.min_iterations must be >= 1 and <= ransac.max_iterations");
  if (!(ransac.confidence > 0.0 && ransac.confidence < 1.0)) return refuse("ransac.confidence must be in (0, 1)");
  if (!(homography_ratio >= 0.0 && homography_ratio <= 1.0)) return refuse("homography_ratio must be in [0, 1]");
  if (!(min_parallax > 0.0 && min_parallax < 45.0)) return refuse("min_parallax must be in (0, 45) degrees");
  if (min_points < kMinMatches) return refuse("min_points must be >= 16");
  if (!(min_point_share >= 0.0 && min_point_share <= 1.0)) return refuse("min_point_share must be in [0, 1]");
  if (min_beside_plane < 1) return refuse("min_beside_plane must be >= 1");
  if (!(min_beside_plane_share >= 0.0 && min_beside_plane_share <= 1.0))
    return refuse("min_beside_plane_share must be in [0, 1]");
  if (!(max_runner_up > 0.0 && max_runner_up <= 1.0)) return refuse("max_runner_up must be in (0, 1]");
  if (iterations < 1 || iterations_without_outliers < 0)
    return refuse("iterations must be >= 1, those without outliers >= 0");
  return {};
}

const char* ToString(TwoViewRefusal refusal) {
  switch (refusal) {
    case TwoViewRefusal::kTooFewMatches:
      return "too few matches";
    case TwoViewRefusal::kNoModel:
      return "no model explains the matches";
    case TwoViewRefusal::kLowParallax:
      return "low parallax";
    case TwoViewRefusal::kAmbiguous:
      return "ambiguous motion";
  }
  return "unknown";
}

tl::expected<TwoViewReconstruction, TwoViewRefusal> ReconstructFromTwoViews(const IdealCamera& camera,
                                                                            std::span<const PixelMatch> matches,
                                                                            const TwoViewOptions& options,
                                                                            std::uint64_t seed) {
  return Reconstructor(camera, matches, options).Run(seed);
}

}  // namespace pangaea
