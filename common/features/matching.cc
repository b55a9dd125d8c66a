#include "common/features/matching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

#include "common/base/check.h"

namespace pangaea {
namespace {

constexpr int kNoDistance = 257;  // more than any
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// The nearest of what was offered, and the distance of the second nearest.
struct BestTwo {
  std::uint32_t best = kNone;
  int best_distance = kNoDistance;
  int second_distance = kNoDistance;

  void Offer(std::uint32_t index, int distance) {
    if (distance < best_distance) {
      second_distance = best_distance;
      best_distance = distance;
      best = index;
    } else if (distance < second_distance) {
      second_distance = distance;
    }
  }
  bool Passes(const MatchOptions& options) const {
    return best != kNone && best_distance <= options.max_distance &&
           (second_distance == kNoDistance || best_distance <= options.max_ratio * second_distance);
  }
};

// Of the matches of one train item, the nearest; of equals the first. Keeps the order.
void KeepOnePerTrain(std::size_t train_size, std::vector<Match>& matches) {
  std::vector<std::uint32_t> kept(train_size, kNone);  // by train item, index into matches
  for (std::uint32_t i = 0; i < matches.size(); ++i) {
    std::uint32_t& best = kept[matches[i].train];
    if (best == kNone || matches[i].distance < matches[best].distance) best = i;
  }
  std::vector<Match> unique;
  for (std::uint32_t i = 0; i < matches.size(); ++i) {
    if (kept[matches[i].train] == i) unique.push_back(matches[i]);
  }
  matches = std::move(unique);
}

// Two keypoints of different octaves this near, in pixels of the coarser, show one corner.
bool ShowOneCorner(const Keypoint& a, const Keypoint& b) {
  constexpr float kSameCornerDistance = 3.0F;
  static const std::array<float, kOctaves> kReach = [] {
    std::array<float, kOctaves> reach;
    for (int o = 0; o < kOctaves; ++o) {
      reach[static_cast<std::size_t>(o)] = kSameCornerDistance * static_cast<float>(OctaveSigma(o));
    }
    return reach;
  }();
  const float reach = kReach[std::min<std::size_t>(std::max(a.octave, b.octave), kOctaves - 1)];
  return a.octave != b.octave && std::abs(a.u - b.u) < reach && std::abs(a.v - b.v) < reach;
}

bool AgreesInDepth(const ProjectionQuery& query, const Keypoint& keypoint) {
  return query.u_right < 0.0F || !keypoint.has_depth() || std::abs(query.u_right - keypoint.u_right) <= query.radius;
}

struct Candidate {
  std::uint32_t index;
  int distance;
};

BestTwo BestOfPlaces(std::span<const Candidate> candidates, std::span<const Keypoint> keypoints) {
  BestTwo best;
  for (const Candidate& candidate : candidates) best.Offer(candidate.index, candidate.distance);
  best.second_distance = kNoDistance;
  for (const Candidate& candidate : candidates) {
    if (candidate.index == best.best || candidate.distance >= best.second_distance) continue;
    if (!ShowOneCorner(keypoints[candidate.index], keypoints[best.best])) best.second_distance = candidate.distance;
  }
  return best;
}

}  // namespace

std::vector<Match> MatchByProjection(std::span<const ProjectionQuery> queries, const FeatureGrid& grid,
                                     std::span<const Descriptor> descriptors, const MatchOptions& options) {
  const std::span<const Keypoint> keypoints = grid.keypoints();
  PANGAEA_CHECK(keypoints.size() == descriptors.size());
  std::vector<Match> matches;
  std::vector<Candidate> candidates;
  for (std::uint32_t q = 0; q < queries.size(); ++q) {
    const ProjectionQuery& query = queries[q];
    candidates.clear();
    grid.ForEachInWindow(query.u, query.v, query.radius, query.min_octave, query.max_octave, [&](std::uint32_t i) {
      if (AgreesInDepth(query, keypoints[i])) {
        candidates.push_back({i, HammingDistance(query.descriptor, descriptors[i])});
      }
    });
    const BestTwo best = BestOfPlaces(candidates, keypoints);
    if (best.Passes(options)) matches.push_back({q, best.best, best.best_distance});
  }
  if (options.unique) KeepOnePerTrain(keypoints.size(), matches);
  return matches;
}

std::vector<Match> MatchBruteForce(std::span<const Descriptor> queries, std::span<const Descriptor> train,
                                   const MatchOptions& options) {
  std::vector<Match> matches;
  std::vector<Candidate> nearest_query(train.size(), {kNone, kNoDistance});  // by train item
  for (std::uint32_t q = 0; q < queries.size(); ++q) {
    BestTwo best;
    for (std::uint32_t t = 0; t < train.size(); ++t) {
      const int distance = HammingDistance(queries[q], train[t]);
      best.Offer(t, distance);
      if (distance < nearest_query[t].distance) nearest_query[t] = {q, distance};
    }
    if (best.Passes(options)) matches.push_back({q, best.best, best.best_distance});
  }
  if (options.unique) {
    std::erase_if(matches, [&](const Match& match) { return nearest_query[match.train].index != match.query; });
  }
  return matches;
}

std::vector<Match> FilterByRotation(std::span<const Match> matches, std::span<const Keypoint> query_keypoints,
                                    std::span<const Keypoint> train_keypoints, int tolerance) {
  PANGAEA_CHECK(tolerance >= 0 && tolerance < 128);
  const auto turn = [&](const Match& match) {
    return static_cast<std::uint8_t>(train_keypoints[match.train].angle - query_keypoints[match.query].angle);
  };
  std::array<int, 256> votes{};
  for (const Match& match : matches) ++votes[turn(match)];
  // The turn with the most votes around it; of equals the smallest.
  int best_turn = 0, best_votes = -1;
  for (int center = 0; center < 256; ++center) {
    int sum = 0;
    for (int i = -tolerance; i <= tolerance; ++i) sum += votes[static_cast<std::size_t>((center + i) & 255)];
    if (sum > best_votes) best_turn = center, best_votes = sum;
  }
  std::vector<Match> kept;
  for (const Match& match : matches) {
    const auto difference = static_cast<std::int8_t>(turn(match) - best_turn);
    if (std::abs(difference) <= tolerance) kept.push_back(match);
  }
  return kept;
}

}  // namespace pangaea
