#pragma once

#include <vector>

#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "common/mapping/landmark_creation_options.h"
#include "common/mapping/measurement_noise.h"

namespace pangaea {

// Landmarks for the keyframe's keypoints that show none, from stereo depth where that is good. The keyframe that begins
// a map (the only one of it) takes farther points than a later one. Ids count up from `first_id`.
std::vector<MapEdit> CreateFromStereo(const Atlas& atlas, const Keyframe& keyframe, LandmarkId first_id,
                                      const LandmarkCreationOptions& options);

// Landmarks for keypoints that still show none, triangulated with `neighbours` in their order; each gets its second
// observation. For monocular keyframes, and for what stereo sees too far away. Ids count up from `first_id`.
std::vector<MapEdit> CreateByTriangulation(const Atlas& atlas, const Keyframe& keyframe,
                                           const std::vector<KeyframeId>& neighbours, LandmarkId first_id,
                                           const LandmarkCreationOptions& options,
                                           const MeasurementNoiseOptions& noise);

}  // namespace pangaea
