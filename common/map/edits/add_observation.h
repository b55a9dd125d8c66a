#pragma once

#include <cstdint>
#include <string_view>

#include "common/map/edits/edit_kind.h"

namespace pangaea {

// An observation of a fused landmark goes to its absorber. Dropped, for agent and server may have come to different
// ends at the same time: one from a culled keyframe or of a landmark that is gone, one at a keypoint that shows a
// landmark already, one of a landmark that the keyframe sees already.
struct AddObservation {
  static constexpr std::uint8_t kTag = 4;
  static constexpr std::uint8_t kVersion = 1;
  static constexpr std::string_view kName = "add_observation";

  LandmarkId landmark;
  KeyframeId keyframe;
  std::uint32_t keypoint = 0;
};

Status Validate(const AddObservation& edit, const Atlas& atlas);
void ApplyValid(const AddObservation& edit, AtlasEditor& editor);
bool TouchesOnly(const AddObservation& edit, SessionId session);
void Encode(const AddObservation& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, AddObservation& edit);

}  // namespace pangaea
