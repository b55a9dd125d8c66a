#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "common/map/edits/edit_kind.h"
#include "common/map/edits/reference_scale.h"
#include "common/map/keyframe.h"

namespace pangaea {

struct TrackedFrame {
  KeyframeId reference;
  FramePose pose;
  ReferenceScale reference_scale = {};
};

// Frames of a culled reference are composed onto its nearest living ancestor; a frame of a stamp that its keyframe
// already holds replaces it; frames whose map is gone are dropped.
struct AddFramePoses {
  static constexpr std::uint8_t kTag = 2;
  static constexpr std::uint8_t kVersion = 2;
  static constexpr std::string_view kName = "add_frame_poses";

  std::vector<TrackedFrame> frames;  // strictly ascending by stamp
};

Status Validate(const AddFramePoses& edit, const Atlas& atlas);
void ApplyValid(const AddFramePoses& edit, AtlasEditor& editor);
bool TouchesOnly(const AddFramePoses& edit, SessionId session);
void Encode(const AddFramePoses& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, AddFramePoses& edit);

}  // namespace pangaea
