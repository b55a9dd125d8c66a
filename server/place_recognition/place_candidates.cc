#include "server/place_recognition/place_candidates.h"

#include <algorithm>

namespace pangaea {
namespace {

bool SeesCommonLandmark(const Keyframe& a, KeyframeId b) {
  return std::ranges::binary_search(a.covisible, b, {}, &Covisibility::keyframe);
}

}  // namespace

std::unordered_set<KeyframeId> Surroundings(const Atlas& atlas, const Keyframe& query,
                                            const PlaceCandidateOptions& options) {
  std::unordered_set<KeyframeId> surroundings = {query.id};
  for (const Covisibility& edge : query.covisible) {
    surroundings.insert(edge.keyframe);
    if (edge.weight < options.min_shared) continue;
    for (const Covisibility& next : atlas.FindKeyframe(edge.keyframe)->covisible) {
      if (next.weight >= options.min_shared) surroundings.insert(next.keyframe);
    }
  }
  return surroundings;
}

std::vector<PlaceCandidate> BestOfEachPlace(const Atlas& atlas, const std::vector<PlaceCandidate>& ranked,
                                            const PlaceCandidateOptions& options) {
  std::vector<PlaceCandidate> best;
  for (const PlaceCandidate& candidate : ranked) {
    if (best.size() == options.places) break;
    const Keyframe* keyframe = atlas.FindKeyframe(candidate.keyframe);
    if (keyframe == nullptr) continue;
    const bool known = std::ranges::any_of(
        best, [&](const PlaceCandidate& better) { return SeesCommonLandmark(*keyframe, better.keyframe); });
    if (!known) best.push_back(candidate);
  }
  return best;
}

}  // namespace pangaea
