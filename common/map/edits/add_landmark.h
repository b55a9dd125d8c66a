#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

#include "common/map/edits/edit_kind.h"
#include "common/map/edits/reference_scale.h"

namespace pangaea {

// A landmark and its first observation: a landmark is never without one. With a culled reference it is gone at once; at
// a keypoint that shows a landmark by now it is that one, and its id forwards to it. The id of a landmark that is gone
// may be used again for the same landmark.
struct AddLandmark {
  static constexpr std::uint8_t kTag = 3;
  static constexpr std::uint8_t kVersion = 2;
  static constexpr std::string_view kName = "add_landmark";

  LandmarkId id;
  KeyframeId reference;
  std::uint32_t keypoint = 0;                                    // of the reference keyframe
  Eigen::Vector3d point_in_reference = Eigen::Vector3d::Zero();  // camera frame of the reference keyframe
  ReferenceScale reference_scale = {};
};

Status Validate(const AddLandmark& edit, const Atlas& atlas);
void ApplyValid(const AddLandmark& edit, AtlasEditor& editor);
bool TouchesOnly(const AddLandmark& edit, SessionId session);
void Encode(const AddLandmark& edit, MapWriter& writer);
void Decode(MapReader& reader, std::uint8_t version, AddLandmark& edit);

}  // namespace pangaea
