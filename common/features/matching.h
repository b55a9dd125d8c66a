#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/descriptor.h"
#include "common/features/feature_grid.h"
#include "common/geometry/keypoint.h"

namespace pangaea {

struct Match {
  std::uint32_t query = 0;
  std::uint32_t train = 0;
  int distance = 0;  // differing bits
  bool operator==(const Match&) const = default;
};

struct MatchOptions {
  // Most differing bits of a match. Unrelated descriptors differ in 128 +- 20 or so; of the same corner seen again,
  // most differ in fewer than 64.
  int max_distance = 64;
  // The best distance must be at most this share of the second best; 1 accepts all.
  double max_ratio = 0.8;
  // Each train item is used once, by the query nearest to it (of equals the first). Brute force: the match must also be
  // the best for its train item among all queries.
  bool unique = true;
};

// Where a landmark should appear, and what it looks like.
struct ProjectionQuery {
  float u = 0.0F;  // predicted pixel
  float v = 0.0F;
  float u_right =
      -1.0F;  // predicted column in the right image; where known, keypoints with depth must agree within radius
  float radius = 0.0F;  // half the window's width, pixels
  int min_octave = 0;
  int max_octave = kOctaves - 1;
  Descriptor descriptor = {};
};

// For each query the best keypoint in its window. The second best of the ratio test is of another place: keypoints of
// other octaves at the same corner do not count. `descriptors` are the grid's keypoints', index by index. Ascending by
// query.
std::vector<Match> MatchByProjection(std::span<const ProjectionQuery> queries, const FeatureGrid& grid,
                                     std::span<const Descriptor> descriptors, const MatchOptions& options = {});

// For each query the best train descriptor of all. Ascending by query.
std::vector<Match> MatchBruteForce(std::span<const Descriptor> queries, std::span<const Descriptor> train,
                                   const MatchOptions& options = {});

// The matches whose keypoints are turned against each other by nearly the same angle: the image turns as a whole. Keeps
// those within `tolerance` (1/256 turns) of the most frequent turn; 21 is 30 degrees.
std::vector<Match> FilterByRotation(std::span<const Match> matches, std::span<const Keypoint> query_keypoints,
                                    std::span<const Keypoint> train_keypoints, int tolerance = 21);

}  // namespace pangaea
