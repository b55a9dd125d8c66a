#include "server/map_comparison/map_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "common/geometry/horn.h"
#include "common/geometry/ransac.h"
#include "common/map/metric_map.h"
#include "server/map_comparison/map_sample.h"
#include "server/map_comparison/point_grid.h"

namespace pangaea {
namespace {

constexpr std::size_t kSampleSize = 3;
constexpr std::size_t kCountedPerCell = 2;
constexpr double kBent = 3.0;
// Below it the numbers are no room's.
constexpr double kLeastDepth = 1e-6;
// Twice: the first motion is that of a handful of landmarks.
constexpr int kGuidedRounds = 2;

struct SurfaceOverlap {
  double overlap = 0.0;  // of the points, that lie in cells where there are others
  double share = 0.0;    // of these, that lie on one of the others
};

SurfaceOverlap OverlapOf(std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector3d> others, double cell,
                         double radius) {
  std::unordered_set<SpaceCell> occupied;
  for (const Eigen::Vector3d& other : others) occupied.insert(CellOf(other, cell));
  const PointGrid grid(others, radius);
  std::size_t common = 0;
  std::size_t lying = 0;
  for (const Eigen::Vector3d& point : points) {
    if (!occupied.contains(CellOf(point, cell))) continue;
    ++common;
    bool lies = false;
    grid.ForEachNear(point, [&](std::uint32_t) { lies = true; });
    lying += lies ? 1 : 0;
  }
  const auto share = [](std::size_t part, std::size_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
  };
  return {share(common, points.size()), share(lying, common)};
}

class Comparing {
 public:
  Comparing(const Atlas& atlas, MapId query, MapId candidate, const MapComparisonOptions& options)
      : atlas_(atlas),
        options_(options),
        query_(SampleMap(atlas, query, options)),
        candidate_(SampleMap(atlas, candidate, options)),
        tolerance_(options.tolerance * std::min(query_.depth, candidate_.depth)),
        cell_(options.cell * std::min(query_.depth, candidate_.depth)),
        candidates_(candidate_.points, tolerance_) {}

  MapComparison Run() {
    comparison_.outcome = Judge();
    if (comparison_.outcome == MapComparisonOutcome::kOnePlace) MakeMatch();
    return std::move(comparison_);
  }

 private:
  MapComparisonOutcome Judge() {
    if (std::min(query_.points.size(), candidate_.points.size()) < options_.min_pairs ||
        std::min(query_.depth, candidate_.depth) < kLeastDepth) {
      return MapComparisonOutcome::kNotComparable;
    }
    std::vector<Match> matches = MatchBruteForce(query_.descriptors, candidate_.descriptors, options_.matching);
    comparison_.matches = matches.size();
    const auto motion = FindMotion(matches);
    if (!motion) return MapComparisonOutcome::kNoMotion;
    comparison_.support = Support(*motion, matches);
    // Where the maps are a little bent, what is true lies beside the best motion as well.
    std::erase_if(matches, [&](const Match& match) { return Residual(*motion, match).norm() <= kBent * tolerance_; });
    const auto rival = FindMotion(matches);
    comparison_.rival_support = rival ? Support(*rival, matches) : 0;
    comparison_.candidate_from_query = *motion;
    const auto lead = options_.min_lead * static_cast<double>(comparison_.rival_support);
    if (static_cast<double>(comparison_.support) < lead) return MapComparisonOutcome::kAmbiguous;
    return Verify();
  }

  MapComparisonOutcome Verify() {
    for (int round = 0; round < kGuidedRounds; ++round) {
      pairs_ = GuidedPairs();
      const auto refined = Align(pairs_);
      if (!refined) return MapComparisonOutcome::kFewPairs;
      comparison_.candidate_from_query = *refined;
    }
    pairs_ = GuidedPairs();
    comparison_.pairs = pairs_.size();
    if (comparison_.pairs < options_.min_pairs) return MapComparisonOutcome::kFewPairs;
    std::unordered_set<SpaceCell> cells;
    for (const Match& pair : pairs_) cells.insert(CellOf(candidate_.points[pair.train], cell_));
    comparison_.cells = cells.size();
    CompareSurfaces();
    if (comparison_.cells < options_.min_cells) return MapComparisonOutcome::kNarrow;
    if (comparison_.overlap < options_.min_overlap) return MapComparisonOutcome::kSmallOverlap;
    const bool agree = comparison_.surface_share >= options_.min_surface_share;
    return agree ? MapComparisonOutcome::kOnePlace : MapComparisonOutcome::kSurfacesDisagree;
  }

  Eigen::Vector3d Residual(const Similarity3d& motion, const Match& match) const {
    return candidate_.points[match.train] - motion * query_.points[match.query];
  }
  bool Fits(const Similarity3d& motion, const Match& match) const {
    return Residual(motion, match).norm() <= tolerance_;
  }

  // Those of one thing that was moved fit as well as those of a whole room: what counts is how widely they are spread.
  std::size_t Support(const Similarity3d& motion, std::span<const Match> matches) const {
    std::unordered_map<SpaceCell, std::size_t> cells;
    for (const Match& match : matches) {
      if (Fits(motion, match)) ++cells[CellOf(candidate_.points[match.train], cell_)];
    }
    std::size_t support = 0;
    for (const auto& [cell, count] : cells) support += std::min(count, kCountedPerCell);
    return support;
  }

  // As far from each other in both maps, and far enough to tell how the maps are turned.
  bool AreConsistent(const Match& a, const Match& b) const {
    const double of_query = (query_.points[a.query] - query_.points[b.query]).norm();
    const double of_candidate = (candidate_.points[a.train] - candidate_.points[b.train]).norm();
    return of_candidate >= cell_ && std::abs(of_query - of_candidate) <= tolerance_;
  }

  std::optional<Similarity3d> Align(std::span<const Match> matches) const {
    std::vector<Eigen::Vector3d> target;
    std::vector<Eigen::Vector3d> source;
    for (const Match& match : matches) {
      target.push_back(candidate_.points[match.train]);
      source.push_back(query_.points[match.query]);
    }
    return AlignPoints(target, source, false);
  }

  std::optional<Similarity3d> FindMotion(const std::vector<Match>& matches) const {
    const auto solve = [&](std::span<const std::size_t> sample, std::vector<Similarity3d>& motions) {
      const std::array<Match, kSampleSize> drawn = {matches[sample[0]], matches[sample[1]], matches[sample[2]]};
      if (!AreConsistent(drawn[0], drawn[1]) || !AreConsistent(drawn[1], drawn[2]) ||
          !AreConsistent(drawn[0], drawn[2])) {
        return;
      }
      if (const auto motion = Align(drawn)) motions.push_back(*motion);
    };
    const auto score = [&](const Similarity3d& motion, std::span<std::uint8_t> inliers) {
      RansacScore judged;
      for (std::size_t i = 0; i < matches.size(); ++i) {
        inliers[i] = Fits(motion, matches[i]) ? 1 : 0;
        judged.inliers += inliers[i];
      }
      judged.cost = -static_cast<double>(Support(motion, matches));
      return judged;
    };
    const auto improve = [&](const Similarity3d&, std::span<const std::uint8_t> inliers) {
      std::vector<Match> fitting;
      for (std::size_t i = 0; i < matches.size(); ++i) {
        if (inliers[i] != 0) fitting.push_back(matches[i]);
      }
      return Align(fitting);
    };
    const RansacOptions ransac{.sample_size = kSampleSize, .max_iterations = options_.ransac_iterations};
    const auto found = Ransac<Similarity3d>(matches.size(), ransac, options_.seed, solve, score, improve);
    // Three fit any motion that they were drawn for.
    if (!found || found->score.inliers <= kSampleSize) return std::nullopt;
    return found->model;
  }

  // Landmarks of the query's map and the one of the candidate's map, of those within the tolerance, that looks most
  // like it. Each occurs once: the pairs that look most alike first.
  std::vector<Match> GuidedPairs() const {
    std::vector<Match> pairs;
    for (std::uint32_t i = 0; i < query_.points.size(); ++i) {
      Match best{i, 0, options_.guided_distance + 1};
      candidates_.ForEachNear(comparison_.candidate_from_query * query_.points[i], [&](std::uint32_t near) {
        const int distance = HammingDistance(query_.descriptors[i], candidate_.descriptors[near]);
        if (distance < best.distance || (distance == best.distance && near < best.train)) best = {i, near, distance};
      });
      if (best.distance <= options_.guided_distance) pairs.push_back(best);
    }
    std::ranges::stable_sort(pairs, {}, &Match::distance);
    std::unordered_set<std::uint32_t> taken;
    std::erase_if(pairs, [&](const Match& pair) { return !taken.insert(pair.train).second; });
    return pairs;
  }

  void CompareSurfaces() {
    const double radius = options_.surface_tolerance * std::min(query_.depth, candidate_.depth);
    std::vector<Eigen::Vector3d> moved;
    for (const Eigen::Vector3d& point : query_.points) moved.push_back(comparison_.candidate_from_query * point);
    const SurfaceOverlap of_query = OverlapOf(moved, candidate_.points, cell_, radius);
    const SurfaceOverlap of_candidate = OverlapOf(candidate_.points, moved, cell_, radius);
    const SurfaceOverlap& larger = of_query.overlap > of_candidate.overlap ? of_query : of_candidate;
    comparison_.overlap = larger.overlap;
    comparison_.surface_share = larger.share;
  }

  // The keyframe that sees most of them; of equals the first.
  KeyframeId BestObserver(const std::vector<LandmarkId>& landmarks) const {
    std::map<KeyframeId, std::size_t> seen;
    for (const LandmarkId id : landmarks) {
      for (const Observation& observation : atlas_.FindLandmark(id)->observations) ++seen[observation.keyframe];
    }
    return std::ranges::max_element(seen, {}, [](const auto& entry) { return entry.second; })->first;
  }

  bool Sees(KeyframeId keyframe, LandmarkId landmark) const {
    return std::ranges::any_of(atlas_.FindLandmark(landmark)->observations,
                               [&](const Observation& observation) { return observation.keyframe == keyframe; });
  }

  void MakeMatch() {
    PlaceMatch match;
    std::vector<LandmarkId> of_query;
    double squares = 0.0;
    for (const Match& pair : pairs_) {
      of_query.push_back(query_.landmarks[pair.query]);
      match.landmarks.emplace_back(of_query.back(), candidate_.landmarks[pair.train]);
      squares += Residual(comparison_.candidate_from_query, pair).squaredNorm();
    }
    match.query = BestObserver(of_query);
    std::vector<LandmarkId> of_candidate;
    for (const auto& [there, here] : match.landmarks) {
      if (Sees(match.query, there)) of_candidate.push_back(here);
    }
    match.candidate = BestObserver(of_candidate);
    match.candidate_from_query = Similarity3d(atlas_.FindKeyframe(match.candidate)->camera_from_map) *
                                 comparison_.candidate_from_query *
                                 Similarity3d(atlas_.FindKeyframe(match.query)->camera_from_map.Inverse());
    match.evidence.matches = comparison_.matches;
    match.evidence.inliers = comparison_.pairs;
    match.evidence.compared = ComparedMaps{.cells = comparison_.cells,
                                           .rms = std::sqrt(squares / static_cast<double>(comparison_.pairs)),
                                           .surface_share = comparison_.surface_share};
    comparison_.match = std::move(match);
  }

  const Atlas& atlas_;
  const MapComparisonOptions& options_;
  const MapSample query_;
  const MapSample candidate_;
  const double tolerance_;  // lengths of both maps, which are metric
  const double cell_;
  const PointGrid candidates_;
  std::vector<Match> pairs_;
  MapComparison comparison_;
};

}  // namespace

MapComparison CompareMaps(const Atlas& atlas, MapId query, MapId candidate, const MapComparisonOptions& options) {
  const bool alive = atlas.FindMap(query) != nullptr && atlas.FindMap(candidate) != nullptr && query != candidate;
  if (!alive || !IsMetric(atlas, query) || !IsMetric(atlas, candidate)) return {};
  return Comparing(atlas, query, candidate, options).Run();
}

}  // namespace pangaea
