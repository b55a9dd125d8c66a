#include "server/fusion/seam.h"

#include <algorithm>
#include <tuple>

namespace pangaea {
namespace {

// By what maps are ranked: less is better.
std::tuple<bool, std::int64_t, MapId> Seniority(const Atlas& atlas, MapId map) {
  const Keyframe& root = *atlas.FindKeyframe(atlas.FindMap(map)->root);
  return {!root.data->camera.is_stereo(), root.data->stamp_ns, map};
}

// The similarity of the map frames that puts two cameras at this motion from each other.
Similarity3d AlignMaps(const Keyframe& target, const Similarity3d& target_from_source, const Keyframe& source) {
  return Similarity3d(target.camera_from_map.Inverse()) * target_from_source * Similarity3d(source.camera_from_map);
}

bool IsIn(const Atlas& atlas, LandmarkId id, MapId map) {
  const Landmark* landmark = atlas.FindLandmark(id);
  return landmark != nullptr && atlas.MapOf(*landmark) == map;
}

// `flipped`: the pairs of the match name the moved side first.
std::vector<std::pair<LandmarkId, LandmarkId>> LivingPairs(const Atlas& atlas, const PlaceMatch& match,
                                                           const Seam& seam, bool flipped) {
  std::vector<std::pair<LandmarkId, LandmarkId>> pairs;
  for (const auto& [of_query, of_candidate] : match.landmarks) {
    const LandmarkId kept = atlas.Resolve(flipped ? of_candidate : of_query);
    const LandmarkId moved = atlas.Resolve(flipped ? of_query : of_candidate);
    if (kept != moved && IsIn(atlas, kept, seam.kept_map) && IsIn(atlas, moved, seam.moved_map)) {
      pairs.emplace_back(kept, moved);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace

MapId Survivor(const Atlas& atlas, MapId a, MapId b) { return Seniority(atlas, a) < Seniority(atlas, b) ? a : b; }

std::optional<Seam> FindSeam(const Atlas& atlas, const PlaceMatch& match) {
  const auto query = atlas.ResolvePose(match.query);
  const auto candidate = atlas.ResolvePose(match.candidate);
  if (!query || !candidate || query->keyframe == candidate->keyframe) return std::nullopt;
  const Similarity3d candidate_from_query = Similarity3d(candidate->keyframe_from_asked) * match.candidate_from_query *
                                            Similarity3d(query->keyframe_from_asked.Inverse());
  const MapId query_map = query->keyframe->map;
  const MapId candidate_map = candidate->keyframe->map;
  const bool keep_candidate = query_map == candidate_map || Survivor(atlas, query_map, candidate_map) == candidate_map;
  const Keyframe& kept = keep_candidate ? *candidate->keyframe : *query->keyframe;
  const Keyframe& moved = keep_candidate ? *query->keyframe : *candidate->keyframe;

  Seam seam;
  seam.kept = kept.id;
  seam.moved = moved.id;
  seam.kept_map = kept.map;
  seam.moved_map = moved.map;
  const Similarity3d motion = keep_candidate ? candidate_from_query : candidate_from_query.Inverse();
  seam.kept_from_moved = AlignMaps(kept, motion, moved);
  seam.scale_free = !IsMetric(atlas, kept.map);
  seam.landmarks = LivingPairs(atlas, match, seam, keep_candidate);
  return seam;
}

}  // namespace pangaea
