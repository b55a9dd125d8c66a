#pragma once

#include <cstdint>
#include <memory>

#include "common/geometry/rigid3.h"
#include "common/map/ids.h"
#include "common/map/keyframe.h"

namespace pangaea {

// Where in the atlas was this frame taken? Asked by an agent that is lost.
struct RelocalizationRequest {
  SessionId session = 0;
  std::uint64_t request = 0;  // 1, 2, 3 … within the session
  std::shared_ptr<const KeyframeData> frame;
};

// The place itself comes as a correction: the pose means something once `reference` is there.
struct RelocalizationAnswer {
  SessionId session = 0;
  std::uint64_t request = 0;
  bool found = false;
  // The members below only where it was found.
  MapId map;
  KeyframeId reference;
  Rigid3d camera_from_reference;  // camera frame of `reference` to that of the frame asked about
  std::uint32_t inliers = 0;      // landmarks that the pose rests on
};

}  // namespace pangaea
