#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "common/geometry/rigid3.h"
#include "common/map/edits/edit_kind.h"
#include "common/map/edits/reference_scale.h"

namespace pangaea {

struct MovedKeyframe {
  KeyframeId id;
  Rigid3d camera_from_reference;  // without a reference: from its parent, of a root from the map
  // What the pose is measured against. The trees of agent and server may differ: said explicitly, it means the same on
  // both sides.
  KeyframeId reference = {};
  ReferenceScale reference_scale = {};
  // By how much the lengths around the keyframe are multiplied; corrections alone scale.
  double scale = 1.0;
  // Of a correction: from now on the server alone moves the keyframe. False where it only comes along.
  bool settles = true;
};

// Applied in the listed order, each against its reference's pose at that moment: list references first. Keyframes that
// are not listed keep their camera_from_map, landmarks their point_in_map. Culled ones are skipped, and those whose
// reference is gone or in another map. Without a correction, also those that a correction has placed.
struct MoveKeyframes {
  static constexpr std::uint8_t kTag = 6;
  static constexpr std::uint8_t kVersion = 2;
  static constexpr std::string_view kName = "move_keyframes";

  std::vector<MovedKeyframe> keyframes;
  std::uint64_t correction = 0;  // of the server's own: its version, see Keyframe::corrected_at; 0: an agent's
};

Status Validate(const MoveKeyframes& edit, const Atlas& atlas);
void ApplyValid(const MoveKeyframes& edit, AtlasEditor& editor);
bool TouchesOnly(const MoveKeyframes& edit, SessionId session);
void Encode(const MoveKeyframes& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, MoveKeyframes& edit);

}  // namespace pangaea
