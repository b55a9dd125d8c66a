#pragma once

#include <cstdint>
#include <string_view>

#include "common/map/edits/edit_kind.h"

namespace pangaea {

// No further keyframes of its session come to the map. Nothing happens where it is merged; where others were merged
// into it, or other sessions have keyframes in it, they may go on.
struct CloseMap {
  static constexpr std::uint8_t kTag = 13;
  static constexpr std::uint8_t kVersion = 1;
  static constexpr std::string_view kName = "close_map";

  MapId map;
};

Status Validate(const CloseMap& edit, const Atlas& atlas);
void ApplyValid(const CloseMap& edit, AtlasEditor& editor);
bool TouchesOnly(const CloseMap& edit, SessionId session);
void Encode(const CloseMap& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, CloseMap& edit);

}  // namespace pangaea
