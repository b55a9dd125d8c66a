#include "server/map_comparison/map_sample.h"

#include <algorithm>
#include <limits>

#include "common/map/spanning_tree.h"
#include "server/optimization/median_depth.h"

namespace pangaea {
namespace {

// Sightings that are looked at: of a landmark seen a hundred times these tell as much.
constexpr std::size_t kSightings = 12;

// Spread over all sightings. Keyframes whose features are not here are left out.
std::vector<Descriptor> Sightings(const Atlas& atlas, const Landmark& landmark) {
  std::vector<Descriptor> sightings;
  const std::size_t count = landmark.observations.size();
  for (std::size_t i = 0; i < std::min(count, kSightings); ++i) {
    const Observation& seen = landmark.observations[i * count / std::min(count, kSightings)];
    const auto& descriptors = atlas.FindKeyframe(seen.keyframe)->data->features.descriptors;
    if (seen.keypoint < descriptors.size()) sightings.push_back(descriptors[seen.keypoint]);
  }
  return sightings;
}

// Not empty.
Descriptor Medoid(const std::vector<Descriptor>& sightings) {
  std::size_t best = 0;
  int least = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    int sum = 0;
    for (const Descriptor& other : sightings) sum += HammingDistance(sightings[i], other);
    if (sum < least) {
      least = sum;
      best = i;
    }
  }
  return sightings[best];
}

}  // namespace

MapSample SampleMap(const Atlas& atlas, MapId map, const MapComparisonOptions& options) {
  std::vector<LandmarkId> enough;
  for (const KeyframeId id : ParentsFirst(atlas, map)) {
    for (const LandmarkId seen : atlas.FindKeyframe(id)->landmarks) {
      const Landmark* landmark = atlas.FindLandmark(seen);
      if (landmark == nullptr || landmark->reference != id) continue;
      if (landmark->observations.size() >= options.min_observations) enough.push_back(landmark->id);
    }
  }
  std::ranges::sort(enough);
  MapSample sample;
  sample.map = map;
  sample.depth = MedianDepth(atlas, map);
  const std::size_t count = std::min(enough.size(), options.max_landmarks);
  for (std::size_t i = 0; i < count; ++i) {
    const Landmark& landmark = *atlas.FindLandmark(enough[i * enough.size() / count]);
    const std::vector<Descriptor> sightings = Sightings(atlas, landmark);
    if (sightings.empty()) continue;
    sample.landmarks.push_back(landmark.id);
    sample.points.push_back(landmark.point_in_map);
    sample.descriptors.push_back(Medoid(sightings));
  }
  return sample;
}

}  // namespace pangaea
