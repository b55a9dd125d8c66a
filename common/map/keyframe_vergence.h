#pragma once

#include <memory>

#include "common/map/atlas.h"
#include "common/map/keyframe.h"

namespace pangaea {

// What the keyframe saw with the columns of its right image as a rig of that vergence (common/geometry/vergence.h,
// radians, from the calibration) would have them. From whatever vergence it comes, the outcome is the same, but for
// keypoints whose right column would leave the image or lie right of the left one: they lose it. The same pointer where
// nothing changes.
std::shared_ptr<const KeyframeData> WithVergence(std::shared_ptr<const KeyframeData> data, double vergence);

// Of the session's newest keyframe, radians; 0 where it has none.
double VergenceOf(const Atlas& atlas, SessionId session);

}  // namespace pangaea
