#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/map/edits/edit_kind.h"
#include "common/map/edits/reference_scale.h"

namespace pangaea {

struct MovedLandmark {
  LandmarkId id;
  Eigen::Vector3d point_in_reference;  // may be behind it: where others move it. Camera frame of the reference
  // The keyframe it is measured from; none: the landmark's reference keyframe, which may be another on the other side.
  KeyframeId reference = {};
  ReferenceScale reference_scale = {};
};

// Fused landmarks and those that are gone are skipped, and where the reference is gone or in another map: the absorber
// has a position of its own.
struct MoveLandmarks {
  static constexpr std::uint8_t kTag = 7;
  static constexpr std::uint8_t kVersion = 2;
  static constexpr std::string_view kName = "move_landmarks";

  std::vector<MovedLandmark> landmarks;
};

Status Validate(const MoveLandmarks& edit, const Atlas& atlas);
void ApplyValid(const MoveLandmarks& edit, AtlasEditor& editor);
bool TouchesOnly(const MoveLandmarks& edit, SessionId session);
void Encode(const MoveLandmarks& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, MoveLandmarks& edit);

}  // namespace pangaea
