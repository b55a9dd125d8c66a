#pragma once

#include <cstdint>
#include <string_view>

#include "common/map/edits/edit_kind.h"
#include "common/map/ids.h"

namespace pangaea {

// The rig of a session turned out to have that vergence: all keyframes of the session that are here get the right
// columns it means (WithVergence). Poses and landmarks stay. Keyframes that come later bring their own.
struct SetVergence {
  static constexpr std::uint8_t kTag = 14;
  static constexpr std::uint8_t kVersion = 1;
  static constexpr std::string_view kName = "set_vergence";

  SessionId session = 0;
  double vergence = 0.0;  // radians, from the calibration; at most kMaxVergence either way
};

Status Validate(const SetVergence& edit, const Atlas& atlas);
void ApplyValid(const SetVergence& edit, AtlasEditor& editor);
bool TouchesOnly(const SetVergence& edit, SessionId session);
void Encode(const SetVergence& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, SetVergence& edit);

}  // namespace pangaea
