#pragma once

#include <cstdint>
#include <string_view>

#include "common/map/edits/edit_kind.h"

namespace pangaea {

// The observations of `absorbed` go to `kept`, and its id forwards there. Where one keyframe observes both, the one of
// `kept` stays and the other keypoint becomes free. Position and reference stay those of `kept`.
struct FuseLandmarks {
  static constexpr std::uint8_t kTag = 8;
  static constexpr std::uint8_t kVersion = 1;
  static constexpr std::string_view kName = "fuse_landmarks";

  LandmarkId kept;
  LandmarkId absorbed;
};

Status Validate(const FuseLandmarks& edit, const Atlas& atlas);
void ApplyValid(const FuseLandmarks& edit, AtlasEditor& editor);
bool TouchesOnly(const FuseLandmarks& edit, SessionId session);
void Encode(const FuseLandmarks& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, FuseLandmarks& edit);

}  // namespace pangaea
