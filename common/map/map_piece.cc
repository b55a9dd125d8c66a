#include "common/map/map_piece.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

namespace pangaea {
namespace {

template <typename T>
void SortUnique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

std::optional<Rigid3d> PoseOf(const Atlas& atlas, KeyframeId culled) {
  const auto resolved = atlas.ResolvePose(culled);
  if (!resolved) return std::nullopt;
  return resolved->keyframe_from_asked.Inverse() * resolved->keyframe->camera_from_map;
}

std::vector<PieceKeyframe> CutKeyframes(const Atlas& atlas, const PieceSelection& selection) {
  std::vector<KeyframeId> ids = selection.keyframes;
  SortUnique(ids);
  std::vector<PieceKeyframe> keyframes;
  for (const KeyframeId id : ids) {
    const Keyframe* keyframe = atlas.FindKeyframe(id);
    if (keyframe == nullptr || keyframe->map != selection.map) continue;
    keyframes.push_back({id, keyframe->camera_from_map, keyframe->corrected_at, keyframe->scale,
                         selection.held.contains(id) ? nullptr : keyframe->data});
  }
  return keyframes;
}

PieceLandmark CutLandmark(const Landmark& landmark, const std::unordered_set<KeyframeId>& listed) {
  PieceLandmark cut{landmark.id, landmark.point_in_map, {}, {}};
  for (const Observation& observation : landmark.observations) {
    if (!listed.contains(observation.keyframe)) continue;
    cut.observations.push_back(observation);
    if (observation.keyframe == landmark.reference) cut.reference = landmark.reference;
  }
  // The true one is not of the piece: any observer will do, the position is absolute.
  if (!cut.reference.valid() && !cut.observations.empty()) cut.reference = cut.observations.front().keyframe;
  return cut;
}

}  // namespace

bool MapPiece::empty() const {
  return keyframes.empty() && landmarks.empty() && fused.empty() && removed.empty() && culled.empty();
}

MapPiece CutPiece(const Atlas& atlas, const PieceSelection& selection) {
  MapPiece piece;
  piece.map = selection.map;
  for (const auto& [absorbed, survivor] : atlas.merged_maps()) {
    if (atlas.Resolve(absorbed) == selection.map) piece.merged.push_back(absorbed);
  }
  piece.keyframes = CutKeyframes(atlas, selection);
  std::unordered_set<KeyframeId> listed;
  for (const PieceKeyframe& keyframe : piece.keyframes) listed.insert(keyframe.id);

  std::vector<LandmarkId> landmarks = selection.landmarks;
  SortUnique(landmarks);
  for (const LandmarkId id : landmarks) {
    const Landmark* landmark = atlas.FindLandmark(id);
    if (landmark == nullptr || atlas.MapOf(*landmark) != selection.map) continue;
    piece.landmarks.push_back(CutLandmark(*landmark, listed));
  }
  std::vector<LandmarkId> former = selection.former_landmarks;
  SortUnique(former);
  for (const LandmarkId id : former) {
    if (atlas.FindLandmark(id) != nullptr || !atlas.Knows(id)) continue;
    const LandmarkId kept = atlas.Resolve(id);
    if (kept.valid()) {
      piece.fused.push_back({id, kept});
    } else {
      piece.removed.push_back(id);
    }
  }
  piece.removed.insert(piece.removed.end(), selection.released_landmarks.begin(), selection.released_landmarks.end());
  SortUnique(piece.removed);
  for (const KeyframeId id : selection.culled) {
    if (atlas.FindKeyframe(id) == nullptr && atlas.Knows(id)) piece.culled.push_back({id, PoseOf(atlas, id)});
  }
  for (const KeyframeId id : selection.released) piece.culled.push_back({id, std::nullopt});
  std::ranges::sort(piece.culled, {}, &GoneKeyframe::id);
  // Not std::ranges::unique: clang 14 cannot read its result type in this standard library.
  const auto same = [](const GoneKeyframe& a, const GoneKeyframe& b) { return a.id == b.id; };
  piece.culled.erase(std::unique(piece.culled.begin(), piece.culled.end(), same), piece.culled.end());
  return piece;
}

}  // namespace pangaea
