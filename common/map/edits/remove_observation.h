#pragma once

#include <cstdint>
#include <string_view>

#include "common/map/edits/edit_kind.h"

namespace pangaea {

// Removing the last observation removes the landmark. Of a fused landmark, it is its absorber's observation that goes.
// Nothing happens where there is no such observation (any more).
struct RemoveObservation {
  static constexpr std::uint8_t kTag = 5;
  static constexpr std::uint8_t kVersion = 1;
  static constexpr std::string_view kName = "remove_observation";

  LandmarkId landmark;
  KeyframeId keyframe;
};

Status Validate(const RemoveObservation& edit, const Atlas& atlas);
void ApplyValid(const RemoveObservation& edit, AtlasEditor& editor);
bool TouchesOnly(const RemoveObservation& edit, SessionId session);
void Encode(const RemoveObservation& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, RemoveObservation& edit);

}  // namespace pangaea
