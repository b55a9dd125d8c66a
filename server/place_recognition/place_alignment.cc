#include "server/place_recognition/place_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "common/estimation/similarity_refinement.h"
#include "common/geometry/horn.h"
#include "common/geometry/ransac.h"
#include "common/mapping/measurement_noise.h"
#include "server/place_recognition/guided_matching.h"

namespace pangaea {
namespace {

constexpr std::size_t kSampleSize = 3;
// Steps with which RANSAC polishes a new best motion: it need not converge.
constexpr int kPolishIterations = 4;

Sighting MakeSighting(const PlaceView& view, const PlaceLandmark& landmark, const PlaceSighting& sighting,
                      const MeasurementNoiseOptions& noise) {
  const PlaceObserver& observer = view.observers[sighting.observer];
  const Keypoint& keypoint = observer.data->features.keypoints[sighting.keypoint];
  return {.point = landmark.point,
          .camera = observer.data->camera,
          .camera_from_side = observer.camera_from_center,
          .measurement = ReliableMeasurementOf(observer.data->camera, keypoint, noise),
          .inverse_sigma = 1.0 / SigmaOf(keypoint, noise)};
}

// A pair for each match, from one of the two sightings that are known of each landmark.
void AppendPairs(const PlaceView& query, const PlaceView& candidate, std::span<const Match> matches,
                 PlaceSighting PlaceLandmark::*sighting, const MeasurementNoiseOptions& noise,
                 std::vector<SightingPair>& pairs) {
  for (const Match& match : matches) {
    const PlaceLandmark& source = query.landmarks[match.query];
    const PlaceLandmark& target = candidate.landmarks[match.train];
    pairs.push_back({.source = MakeSighting(query, source, source.*sighting, noise),
                     .target = MakeSighting(candidate, target, target.*sighting, noise)});
  }
}

std::vector<SightingPair> MakePairs(const PlaceView& query, const PlaceView& candidate, std::span<const Match> matches,
                                    const MeasurementNoiseOptions& noise) {
  std::vector<SightingPair> pairs;
  AppendPairs(query, candidate, matches, &PlaceLandmark::first, noise, pairs);
  // Two cameras at one position see the same at any scale: only others beside them tell it.
  if (!IsMetric(query, candidate)) AppendPairs(query, candidate, matches, &PlaceLandmark::far, noise, pairs);
  return pairs;
}

class MotionSearch {
 public:
  MotionSearch(std::vector<SightingPair> pairs, bool with_scale, double sigmas)
      : pairs_(std::move(pairs)), limit_(sigmas * sigmas) {
    refinement_.with_scale = with_scale;
    refinement_.rounds = 1;
    refinement_.max_iterations = kPolishIterations;
    refinement_.monocular_chi2 = refinement_.stereo_chi2 = limit_;
  }

  std::size_t size() const { return pairs_.size(); }

  void Solve(std::span<const std::size_t> sample, std::vector<Similarity3d>& motions) const {
    std::array<Eigen::Vector3d, kSampleSize> target;
    std::array<Eigen::Vector3d, kSampleSize> source;
    for (std::size_t i = 0; i < kSampleSize; ++i) {
      target[i] = pairs_[sample[i]].target.point;
      source[i] = pairs_[sample[i]].source.point;
    }
    const auto motion = AlignPoints(target, source, refinement_.with_scale);
    if (motion) motions.push_back(*motion);
  }

  // MSAC (Torr and Zisserman 2000): squared errors cut off at their limit, the worse of the two images.
  RansacScore Score(const Similarity3d& target_from_source, std::span<std::uint8_t> inliers) const {
    RansacScore score{0.0, 0};
    const Similarity3d source_from_target = target_from_source.Inverse();
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const PairErrors errors = ErrorsOf(pairs_[i], target_from_source, source_from_target);
      const double worse = std::max(errors.in_target, errors.in_source);
      const bool is_inlier = worse <= limit_;  // false for NaN
      inliers[i] = is_inlier ? 1 : 0;
      score.inliers += inliers[i];
      score.cost += is_inlier ? worse / limit_ : 1.0;
    }
    return score;
  }

  std::optional<Similarity3d> Improve(const Similarity3d& motion, std::span<const std::uint8_t> inliers) const {
    std::vector<std::uint8_t> flags(inliers.begin(), inliers.end());
    const auto refined = RefineSimilarity(pairs_, motion, refinement_, flags);
    if (!refined) return std::nullopt;
    return refined->target_from_source;
  }

 private:
  std::vector<SightingPair> pairs_;
  double limit_;
  SimilarityRefinementOptions refinement_;
};

std::optional<PlaceAlignment> SearchAndRefine(const PlaceView& query, const PlaceView& candidate,
                                              const Similarity3d& candidate_from_query, double radius,
                                              const PlaceGeometryOptions& options) {
  const auto matches = SearchLandmarkPairs(query, candidate, candidate_from_query, radius, options);
  const auto pairs = MakePairs(query, candidate, matches, options.noise);
  std::vector<std::uint8_t> inliers(pairs.size(), 1);
  const SimilarityRefinementOptions refinement{.with_scale = !IsMetric(query, candidate)};
  const auto refined = RefineSimilarity(pairs, candidate_from_query, refinement, inliers);
  if (!refined) return std::nullopt;
  PlaceAlignment alignment{.candidate_from_query = refined->target_from_source,
                           .pairs = {},
                           .candidates = matches.size(),
                           .rms_sigmas = std::sqrt(refined->mean_squared_error)};
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const bool fits = inliers[i] != 0 && (inliers.size() == matches.size() || inliers[matches.size() + i] != 0);
    if (fits) alignment.pairs.push_back(matches[i]);
  }
  return alignment;
}

}  // namespace

bool IsMetric(const PlaceView& query, const PlaceView& candidate) {
  return query.center().data->camera.is_stereo() && candidate.center().data->camera.is_stereo();
}

std::optional<Similarity3d> FindMotion(const PlaceView& query, const PlaceView& candidate,
                                       std::span<const Match> matches, const PlaceGeometryOptions& options,
                                       std::uint64_t seed, std::size_t& aligned) {
  std::vector<SightingPair> pairs;
  AppendPairs(query, candidate, matches, &PlaceLandmark::first, options.noise, pairs);
  const MotionSearch search(std::move(pairs), !IsMetric(query, candidate), options.ransac_sigmas);
  const RansacOptions ransac{.sample_size = kSampleSize, .max_iterations = options.ransac_iterations};
  const auto best = Ransac<Similarity3d>(
      search.size(), ransac, seed,
      [&](std::span<const std::size_t> sample, std::vector<Similarity3d>& motions) { search.Solve(sample, motions); },
      [&](const Similarity3d& motion, std::span<std::uint8_t> inliers) { return search.Score(motion, inliers); },
      [&](const Similarity3d& motion, std::span<const std::uint8_t> inliers) {
        return search.Improve(motion, inliers);
      });
  if (!best) return std::nullopt;
  aligned = best->score.inliers;
  if (aligned < options.min_aligned) return std::nullopt;
  return best->model;
}

std::optional<PlaceAlignment> RefineAlignment(const PlaceView& query, const PlaceView& candidate,
                                              const Similarity3d& candidate_from_query,
                                              const PlaceGeometryOptions& options, AlignmentCounts& counts) {
  const auto wide = SearchAndRefine(query, candidate, candidate_from_query, options.wide_radius, options);
  if (!wide) return std::nullopt;
  counts.guided = wide->pairs.size();
  if (counts.guided < options.min_guided) return std::nullopt;
  auto narrow = SearchAndRefine(query, candidate, wide->candidate_from_query, options.narrow_radius, options);
  if (!narrow) return std::nullopt;
  counts.inliers = narrow->pairs.size();
  if (counts.inliers < options.min_inliers) return std::nullopt;
  return narrow;
}

}  // namespace pangaea
