#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "common/geometry/rigid3.h"
#include "common/map/edits/edit_kind.h"

namespace pangaea {

struct MovedKeyframe {
  KeyframeId id;
  Rigid3d camera_from_parent;  // of a root: its camera_from_map
};

// Applied in the listed order, each against its parent's pose at that moment: list parents before children.
// Keyframes that are not listed keep their camera_from_map, landmarks their point_in_map. Culled ones are skipped.
struct MoveKeyframes {
  static constexpr std::uint8_t kTag = 6;
  static constexpr std::uint8_t kVersion = 1;
  static constexpr std::string_view kName = "move_keyframes";

  std::vector<MovedKeyframe> keyframes;
};

Status Validate(const MoveKeyframes& edit, const Atlas& atlas);
void ApplyValid(const MoveKeyframes& edit, AtlasEditor& editor);
bool TouchesOnly(const MoveKeyframes& edit, SessionId session);
void Encode(const MoveKeyframes& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, MoveKeyframes& edit);

}  // namespace pangaea
