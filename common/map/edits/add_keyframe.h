#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "common/geometry/rigid3.h"
#include "common/map/edits/edit_kind.h"
#include "common/map/edits/reference_scale.h"
#include "common/map/keyframe.h"

namespace pangaea {

// A keyframe enters `map`. Without a parent it is the root of a new map and camera_from_parent is its camera_from_map.
// With one, the map is that of its parent (`map` may be merged by now); a culled parent is replaced by its nearest
// living ancestor. Pixels are whole multiples of kPixelQuantum, u_right is -1 where unknown.
struct AddKeyframe {
  static constexpr std::uint8_t kTag = 1;
  static constexpr std::uint8_t kVersion = 2;
  static constexpr std::string_view kName = "add_keyframe";

  KeyframeId id;
  MapId map;
  KeyframeId parent;
  Rigid3d camera_from_parent;
  std::shared_ptr<const KeyframeData> data;
  ReferenceScale parent_scale = {};
};

Status Validate(const AddKeyframe& edit, const Atlas& atlas);
void ApplyValid(const AddKeyframe& edit, AtlasEditor& editor);
bool TouchesOnly(const AddKeyframe& edit, SessionId session);
void Encode(const AddKeyframe& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, AddKeyframe& edit);

}  // namespace pangaea
