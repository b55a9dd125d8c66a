#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "common/map/edits/edits.h"
#include "common/map/ids.h"
#include "common/map/keyframe.h"
#include "common/map/landmark.h"

namespace pangaea {

struct MapInfo {
  MapId id;
  KeyframeId root;
  std::uint32_t keyframes = 0;
  std::uint32_t landmarks = 0;
  bool closed = false;  // no further keyframes from its agent
};

// All maps of a site (on the server) or of one agent. Changed by Apply(MapEdit, Atlas&) alone, by the one thread that
// owns it. Copying it is cheap (copy-on-write in chunks): a copy is a snapshot, and const copies may be read by any
// number of threads while the owner goes on.
class Atlas {
 public:
  const Keyframe* FindKeyframe(KeyframeId id) const;   // nullptr where there is none
  const Landmark* FindLandmark(LandmarkId id) const;   // nullptr where there is none
  const MapInfo* FindMap(MapId id) const;              // nullptr where there is none
  // The id under which something lives now: of a fused landmark the one that absorbed it, of a culled keyframe its
  // nearest living ancestor; the same id for what is alive; none where it never was or is gone without a trace.
  KeyframeId Resolve(KeyframeId id) const;
  LandmarkId Resolve(LandmarkId id) const;

  std::vector<MapId> Maps() const;  // ascending
  // Ascending by id.
  void ForEachKeyframe(const std::function<void(const Keyframe&)>& visit) const;
  void ForEachLandmark(const std::function<void(const Landmark&)>& visit) const;
  std::size_t keyframe_count() const;
  std::size_t landmark_count() const;
  std::uint64_t version() const;  // grows by one with each applied edit
};

}  // namespace pangaea
