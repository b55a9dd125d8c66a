#include "server/storage/undo_replay.h"

#include <algorithm>
#include <variant>

#include "common/map/map_edit.h"
#include "server/ingest/agent_edit.h"

namespace pangaea {
namespace {

// The maps that edits of the server's own concern, as an atlas without some of them calls them.
class ConcernedMaps {
 public:
  explicit ConcernedMaps(const Atlas& atlas) : atlas_(atlas) {}

  void operator()(const AddKeyframe& edit) { Add(edit.map), Add(edit.parent); }
  void operator()(const AddFramePoses& edit) {
    for (const TrackedFrame& frame : edit.frames) Add(frame.reference);
  }
  void operator()(const AddLandmark& edit) { Add(edit.reference); }
  void operator()(const AddObservation& edit) { Add(edit.landmark), Add(edit.keyframe); }
  void operator()(const RemoveObservation& edit) { Add(edit.landmark), Add(edit.keyframe); }
  void operator()(const MoveKeyframes& edit) {
    for (const MovedKeyframe& moved : edit.keyframes) Add(moved.id);
  }
  void operator()(const MoveLandmarks& edit) {
    for (const MovedLandmark& moved : edit.landmarks) Add(moved.id);
  }
  void operator()(const FuseLandmarks& edit) { Add(edit.kept), Add(edit.absorbed); }
  void operator()(const RemoveKeyframe& edit) { Add(edit.id); }
  void operator()(const RemoveLandmark& edit) { Add(edit.id); }
  void operator()(const AddLoopEdge& edit) { Add(edit.from), Add(edit.to); }
  void operator()(const MergeMaps& edit) { Add(edit.survivor), Add(edit.absorbed); }
  void operator()(const CloseMap& edit) { Add(edit.map); }
  void operator()(const SetVergence&) {}  // agents alone set it

  std::set<MapId> maps;

 private:
  void Add(MapId id) {
    if (const MapId map = atlas_.Resolve(id); map.valid()) maps.insert(map);
  }
  void Add(KeyframeId id) {
    if (const Keyframe* keyframe = atlas_.FindKeyframe(atlas_.Resolve(id))) maps.insert(keyframe->map);
  }
  void Add(LandmarkId id) {
    if (const Landmark* landmark = atlas_.FindLandmark(atlas_.Resolve(id))) maps.insert(atlas_.MapOf(*landmark));
  }

  const Atlas& atlas_;
};

// A keyframe that its agent hung below one of a map which is another one now.
MapEdit StayWithParent(const MapEdit& edit, const Atlas& atlas) {
  const auto* keyframe = std::get_if<AddKeyframe>(&edit);
  if (keyframe == nullptr) return edit;
  const Keyframe* parent = atlas.FindKeyframe(atlas.Resolve(keyframe->parent));
  if (parent == nullptr || parent->map == atlas.Resolve(keyframe->map)) return edit;
  AddKeyframe moved = *keyframe;
  moved.map = parent->map;
  return moved;
}

}  // namespace

void UndoReplay::TakeAgents(const std::vector<MapEdit>& edits) {
  for (const MapEdit& edit : edits) TakeTolerantly(edit);
}

bool UndoReplay::TakeServers(const std::vector<MapEdit>& edits, const std::string& cause) {
  const std::set<MapId> maps = MapsOf(edits);
  const bool is_cause = cause == cause_;
  const bool builds_on_it = std::ranges::any_of(maps, [this](MapId map) { return touched_.contains(map); });
  if (!is_cause && !builds_on_it) {
    for (const MapEdit& edit : edits) (void)Apply(edit, atlas_);
    return true;
  }
  touched_.insert(maps.begin(), maps.end());
  if (!is_cause) also_.insert(cause);
  for (const MapEdit& edit : edits) {
    const auto* merge = std::get_if<MergeMaps>(&edit);
    if (is_cause && merge != nullptr) {
      separated_.emplace_back(atlas_.Resolve(merge->survivor), atlas_.Resolve(merge->absorbed));
    }
  }
  return false;
}

void UndoReplay::TakeTolerantly(const MapEdit& edit) {
  if (!ApplyAgentEdit(StayWithParent(edit, atlas_), atlas_)) ++misfits_;
}

std::set<MapId> UndoReplay::MapsOf(const std::vector<MapEdit>& edits) const {
  ConcernedMaps concerned(atlas_);
  for (const MapEdit& edit : edits) std::visit(concerned, edit);
  return concerned.maps;
}

}  // namespace pangaea
