#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <variant>
#include <vector>

#include "common/geometry/similarity3.h"
#include "common/map/copy_on_write.h"
#include "common/map/id_table.h"
#include "common/map/ids.h"
#include "common/map/keyframe.h"
#include "common/map/landmark.h"

namespace pangaea {

struct MapInfo {
  MapId id;
  KeyframeId root;  // its camera pose is the gauge: it cannot be removed while it has children
  std::uint32_t keyframes = 0;
  std::uint32_t landmarks = 0;
  bool closed = false;  // no further keyframes from its agent
};

// A measured motion between two keyframes of one map, kept for the pose graph.
struct LoopEdge {
  KeyframeId from;
  KeyframeId to;
  Similarity3d to_from_from;  // camera frame of `from` to camera frame of `to`
};

// Where a culled keyframe hung.
struct CulledKeyframe {
  KeyframeId parent;
  Rigid3d parent_from_culled;
};

// A living keyframe and the motion to its camera frame from that of the id that was asked for.
struct ResolvedKeyframe {
  const Keyframe* keyframe;
  Rigid3d keyframe_from_asked;
};

// All maps of a site (on the server) or of one agent. Changed by Apply(MapEdit, Atlas&) alone, by the one thread that
// owns it. Copying it is cheap (copy-on-write in chunks): a copy is a snapshot, and const copies may be read by any
// number of threads while the owner goes on. Pointers into it are valid until its next change.
class Atlas {
 public:
  const Keyframe* FindKeyframe(KeyframeId id) const;  // nullptr where there is none
  const Landmark* FindLandmark(LandmarkId id) const;  // nullptr where there is none
  const MapInfo* FindMap(MapId id) const;             // nullptr where there is none
  // The id under which something lives now: of a fused landmark the one that absorbed it, of a culled keyframe its
  // nearest living ancestor, of a merged map the survivor; the same id for what is alive; none where it never was or
  // is gone without a trace.
  KeyframeId Resolve(KeyframeId id) const;
  LandmarkId Resolve(LandmarkId id) const;
  MapId Resolve(MapId id) const;
  // As Resolve, with the motion that has to be composed onto poses relative to the id that was asked for.
  std::optional<ResolvedKeyframe> ResolvePose(KeyframeId id) const;
  // Whether the id was ever in use here: alive, forwarded or gone. Late edits to known ids are no errors.
  bool Knows(KeyframeId id) const;
  bool Knows(LandmarkId id) const;
  // nullptr where the keyframe is not culled, or was the last of its map.
  const CulledKeyframe* FindCulled(KeyframeId id) const;
  // The map of a landmark is that of its reference keyframe.
  MapId MapOf(const Landmark& landmark) const;

  std::vector<MapId> Maps() const;          // ascending
  std::vector<SessionId> Sessions() const;  // ascending; all that ever had an id here
  // Ascending by id.
  void ForEachKeyframe(const std::function<void(const Keyframe&)>& visit) const;
  void ForEachLandmark(const std::function<void(const Landmark&)>& visit) const;
  void ForEachKeyframe(SessionId session, const std::function<void(const Keyframe&)>& visit) const;
  void ForEachLandmark(SessionId session, const std::function<void(const Landmark&)>& visit) const;
  std::size_t keyframe_count() const { return keyframe_count_; }
  std::size_t landmark_count() const { return landmark_count_; }
  std::size_t keyframe_count(SessionId session) const;
  std::size_t landmark_count(SessionId session) const;
  // Ids that live no more, ascending. Of a keyframe where it hung (nullptr: gone), of a landmark the one it was fused
  // into (none: gone), of a map the survivor it was merged into.
  void ForEachFormerKeyframe(const std::function<void(KeyframeId, const CulledKeyframe*)>& visit) const;
  void ForEachFormerLandmark(const std::function<void(LandmarkId, LandmarkId)>& visit) const;
  const std::map<MapId, MapId>& merged_maps() const;
  const std::vector<LoopEdge>& loop_edges() const;    // in the order they were added; both ends alive
  std::uint64_t version() const { return version_; }  // grows by one with each applied edit

 private:
  friend class AtlasEditor;

  struct Gone {};  // was here, forwards to nothing
  using KeyframeSlot = std::variant<std::monostate, CopyOnWrite<Keyframe>, CulledKeyframe, Gone>;
  using LandmarkSlot = std::variant<std::monostate, Landmark, LandmarkId, Gone>;  // an id: fused into it
  struct Part {
    SessionId session = 0;
    std::size_t keyframe_count = 0;
    std::size_t landmark_count = 0;
    IdTable<KeyframeSlot, 16, 64> keyframes;
    // Of a session that others mapped the same place with, few landmarks are left: small chunks.
    IdTable<LandmarkSlot, 4, 512> landmarks;
  };
  struct MapTable {
    std::map<MapId, MapInfo> living;
    std::map<MapId, MapId> merged;  // absorbed map → survivor
  };

  const Part* FindPart(SessionId session) const;
  const KeyframeSlot* FindSlot(KeyframeId id) const;
  const LandmarkSlot* FindSlot(LandmarkId id) const;
  static const Keyframe* Living(const KeyframeSlot& slot);

  WriteMark mark_;
  std::vector<Part> parts_;  // ascending by session
  CopyOnWrite<MapTable> maps_;
  CopyOnWrite<std::vector<LoopEdge>> loop_edges_;
  std::size_t keyframe_count_ = 0;
  std::size_t landmark_count_ = 0;
  std::uint64_t version_ = 0;
};

}  // namespace pangaea
