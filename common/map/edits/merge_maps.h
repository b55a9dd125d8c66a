#pragma once

#include <cstdint>
#include <string_view>

#include "common/geometry/similarity3.h"
#include "common/map/edits/edit_kind.h"

namespace pangaea {

// All of the absorbed map moves into the frame of the survivor, its lengths (frames, loop edges, culled keyframes)
// scaled along; its tree is re-rooted at its attachment, and its id forwards to the survivor. The joined map is closed
// where both were. From then on the server alone moves what was absorbed.
struct MergeMaps {
  static constexpr std::uint8_t kTag = 12;
  static constexpr std::uint8_t kVersion = 2;
  static constexpr std::string_view kName = "merge_maps";

  MapId survivor;
  MapId absorbed;
  Similarity3d survivor_from_absorbed;
  // The keyframe of the absorbed map that hangs below one of the survivor in the joined spanning tree.
  KeyframeId absorbed_attachment;
  KeyframeId survivor_attachment;
  std::uint64_t correction = 0;  // its version, see Keyframe::corrected_at
};

Status Validate(const MergeMaps& edit, const Atlas& atlas);
void ApplyValid(const MergeMaps& edit, AtlasEditor& editor);
bool TouchesOnly(const MergeMaps& edit, SessionId session);
void Encode(const MergeMaps& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, MergeMaps& edit);

}  // namespace pangaea
