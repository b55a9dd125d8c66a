#pragma once

#include <cstdint>
#include <string_view>

#include "common/map/edits/edit_kind.h"

namespace pangaea {

// Its children and its frames, its own among them, go to its parent, and its id forwards there. A root's first child
// takes its place and is its parent here: trees of agent and server may have different roots, and what one side culls
// the other must be able to cull. Without children the map goes with it.
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
