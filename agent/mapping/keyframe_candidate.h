#pragma once

#include <memory>
#include <vector>

#include "common/geometry/rigid3.h"
#include "common/map/edits/reference_scale.h"
#include "common/map/ids.h"
#include "common/map/keyframe.h"

namespace pangaea {

// What tracking hands to local mapping: a frame worth keeping. Tracking numbers keyframes and maps, local mapping
// numbers landmarks.
struct KeyframeCandidate {
  KeyframeId id;
  MapId map;
  std::shared_ptr<const KeyframeData> data;
  // The keyframe it was tracked against; none where it is the first of a new map.
  KeyframeId reference;
  Rigid3d camera_from_reference;  // camera frame of `reference` to the camera frame of the candidate
  // The landmark tracked at each keypoint; none where none. As long as data->features.keypoints. Some may have been
  // fused or culled since: resolve them.
  std::vector<LandmarkId> landmarks;
  ReferenceScale reference_scale = {};  // of `reference` when camera_from_reference was measured
};

}  // namespace pangaea
