#include "agent/absorption/absorption.h"

#include <algorithm>
#include <map>
#include <set>

#include "agent/absorption/absorption_draft.h"
#include "common/map/forgetting.h"
#include "common/map/spanning_tree.h"

namespace pangaea {
namespace {

// The agent's maps that are one map at the server, open ones first.
std::vector<MapId> MapsOf(const MapPiece& piece, const Atlas& atlas) {
  std::set<MapId> maps;
  maps.insert(atlas.Resolve(piece.map));
  for (const MapId id : piece.merged) maps.insert(atlas.Resolve(id));
  maps.erase(MapId{});
  std::vector<MapId> ordered(maps.begin(), maps.end());
  std::stable_partition(ordered.begin(), ordered.end(), [&](MapId id) { return !atlas.FindMap(id)->closed; });
  return ordered;
}

// The session's keyframe that observes most of what the piece's keyframes see; the map's root where none does.
KeyframeId Attachment(const MapPiece& piece, MapId host, const AbsorptionDraft& draft) {
  std::map<KeyframeId, int> shared;
  for (const PieceLandmark& listed : piece.landmarks) {
    const Landmark* landmark = draft.atlas().FindLandmark(draft.atlas().Resolve(listed.id));
    if (landmark == nullptr || draft.atlas().MapOf(*landmark) != host) continue;
    for (const Observation& observation : landmark->observations) {
      if (draft.IsOwn(observation.keyframe)) ++shared[observation.keyframe];
    }
  }
  const auto most =
      std::max_element(shared.begin(), shared.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == shared.end() ? draft.atlas().FindMap(host)->root : most->first;
}

// The scale of a keyframe is that of its parent at first.
void PlaceExactly(const PieceKeyframe& listed, AbsorptionDraft& draft) {
  const Keyframe& keyframe = *draft.atlas().FindKeyframe(listed.id);
  if (keyframe.scale == listed.scale) return;
  MoveKeyframes edit = MoveKeyframesTo(draft.atlas(), std::vector{std::pair(listed.id, listed.camera_from_map)});
  edit.correction = draft.input().version;
  for (MovedKeyframe& moved : edit.keyframes) moved.scale = listed.scale / keyframe.scale;
  draft.Emit(std::move(edit));
}

// It was forgotten before the server made the piece. Of what was forgotten since, it says what is no longer wanted.
bool IsAskedBack(const Keyframe& keyframe, const AbsorptionDraft& draft) {
  const Keyframe* told = draft.told().FindKeyframe(keyframe.id);
  return IsForgotten(keyframe) && told != nullptr && IsForgotten(*told);
}

}  // namespace

MapId JoinMaps(const MapPiece& piece, AbsorptionDraft& draft) {
  const std::vector<MapId> maps = MapsOf(piece, draft.atlas());
  if (maps.empty()) return {};
  const MapId host = maps.front();
  for (const MapId absorbed : std::span(maps).subspan(1)) {
    // Their poses are the server's business: the next step moves all of them into its frame.
    draft.Emit(MergeMaps{host, absorbed, Similarity3d(), draft.atlas().FindMap(absorbed)->root,
                         draft.atlas().FindMap(host)->root});
  }
  return host;
}

void RemoveCulled(const MapPiece& piece, AbsorptionDraft& draft) {
  std::vector<KeyframeId> culled;
  for (const GoneKeyframe& keyframe : piece.culled) culled.push_back(keyframe.id);
  std::vector<KeyframeId> present = ParentsFirst(draft.atlas(), culled);
  std::reverse(present.begin(), present.end());
  for (const KeyframeId id : present) draft.Emit(RemoveKeyframe{id});
}

void InsertKeyframes(const MapPiece& piece, MapId host, AbsorptionDraft& draft) {
  KeyframeId parent = host.valid() ? Attachment(piece, host, draft) : KeyframeId{};
  for (const PieceKeyframe& listed : piece.keyframes) {
    if (listed.data == nullptr) continue;
    if (const Keyframe* present = draft.atlas().FindKeyframe(listed.id)) {
      // The piece has moved it already.
      if (IsAskedBack(*present, draft)) draft.Emit(AddKeyframe{listed.id, present->map, {}, {}, listed.data});
      continue;
    }
    if (draft.atlas().Knows(listed.id)) continue;
    const Keyframe* above = draft.atlas().FindKeyframe(parent);
    const Rigid3d camera_from_parent =
        above == nullptr ? listed.camera_from_map : listed.camera_from_map * above->camera_from_map.Inverse();
    const MapId map = above == nullptr ? piece.map : above->map;
    if (!draft.Emit(AddKeyframe{listed.id, map, parent, camera_from_parent, listed.data})) continue;
    PlaceExactly(listed, draft);
    if (!parent.valid()) parent = listed.id;
  }
}

Absorption PlanAbsorption(const Atlas& atlas, const AbsorptionInput& input) {
  AbsorptionDraft draft(atlas, input);
  for (const MapPiece& piece : input.pieces) {
    const MapId host = JoinMaps(piece, draft);
    if (host.valid()) MoveToServersFrame(piece, host, draft);
    InsertKeyframes(piece, host, draft);
    AbsorbLandmarks(piece, draft);
  }
  // From where the server has them, so that what they forward to is the same; and once their landmarks have found other
  // observers, in whatever piece.
  for (const MapPiece& piece : input.pieces) RemoveCulled(piece, draft);
  return std::move(draft).Take();
}

bool IsReadOnly(const Keyframe& keyframe, SessionId session) {
  return keyframe.id.session != session || keyframe.corrected_at != 0;
}

bool IsReadOnly(const Atlas& atlas, const Landmark& landmark, SessionId session) {
  if (landmark.id.session != session) return true;
  const Keyframe* reference = atlas.FindKeyframe(landmark.reference);
  return reference != nullptr && IsReadOnly(*reference, session);
}

}  // namespace pangaea
