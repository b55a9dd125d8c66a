#pragma once

#include <cstdint>
#include <string_view>

#include "common/geometry/similarity3.h"
#include "common/map/edits/edit_kind.h"

namespace pangaea {

// A measured motion between two keyframes of one map. A culled end is replaced by its nearest living
// ancestor; dropped where that leaves a keyframe with itself.
struct AddLoopEdge {
  static constexpr std::uint8_t kTag = 11;
  static constexpr std::uint8_t kVersion = 1;
  static constexpr std::string_view kName = "add_loop_edge";

  KeyframeId from;
  KeyframeId to;
  Similarity3d to_from_from;  // camera frame of `from` to camera frame of `to`
};

Status Validate(const AddLoopEdge& edit, const Atlas& atlas);
void ApplyValid(const AddLoopEdge& edit, AtlasEditor& editor);
bool TouchesOnly(const AddLoopEdge& edit, SessionId session);
void Encode(const AddLoopEdge& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, AddLoopEdge& edit);

}  // namespace pangaea
