#pragma once

#include <variant>

#include "common/map/edits/add_frame_poses.h"
#include "common/map/edits/add_keyframe.h"
#include "common/map/edits/add_landmark.h"
#include "common/map/edits/add_loop_edge.h"
#include "common/map/edits/add_observation.h"
#include "common/map/edits/close_map.h"
#include "common/map/edits/fuse_landmarks.h"
#include "common/map/edits/merge_maps.h"
#include "common/map/edits/move_keyframes.h"
#include "common/map/edits/move_landmarks.h"
#include "common/map/edits/remove_keyframe.h"
#include "common/map/edits/remove_landmark.h"
#include "common/map/edits/remove_observation.h"
#include "common/map/edits/set_vergence.h"

namespace pangaea {

// Every change to an atlas.
using MapEdit = std::variant<AddKeyframe, AddFramePoses, AddLandmark, AddObservation, RemoveObservation, MoveKeyframes,
                             MoveLandmarks, FuseLandmarks, RemoveKeyframe, RemoveLandmark, AddLoopEdge, MergeMaps,
                             CloseMap, SetVergence>;

}  // namespace pangaea
