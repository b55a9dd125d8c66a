#pragma once

#include <cstdint>
#include <string_view>

#include "common/map/edits/edit_kind.h"

namespace pangaea {

// Nothing happens where it is fused or gone already.
struct RemoveLandmark {
  static constexpr std::uint8_t kTag = 10;
  static constexpr std::uint8_t kVersion = 1;
  static constexpr std::string_view kName = "remove_landmark";

  LandmarkId id;
};

Status Validate(const RemoveLandmark& edit, const Atlas& atlas);
void ApplyValid(const RemoveLandmark& edit, AtlasEditor& editor);
bool TouchesOnly(const RemoveLandmark& edit, SessionId session);
void Encode(const RemoveLandmark& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, RemoveLandmark& edit);

}  // namespace pangaea
