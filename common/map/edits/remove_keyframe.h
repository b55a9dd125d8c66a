#pragma once

#include <cstdint>
#include <string_view>

#include "common/map/edits/edit_kind.h"

namespace pangaea {

// Its children and its frames, its own among them, go to its parent, and its id forwards there. The root of a map holds
// the map's origin and cannot be removed while it has children; without any, the map goes with it.
struct RemoveKeyframe {
  static constexpr std::uint8_t kTag = 9;
  static constexpr std::uint8_t kVersion = 1;
  static constexpr std::string_view kName = "remove_keyframe";

  KeyframeId id;
};

Status Validate(const RemoveKeyframe& edit, const Atlas& atlas);
void ApplyValid(const RemoveKeyframe& edit, AtlasEditor& editor);
bool TouchesOnly(const RemoveKeyframe& edit, SessionId session);
void Encode(const RemoveKeyframe& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, RemoveKeyframe& edit);

}  // namespace pangaea
