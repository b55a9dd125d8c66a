#pragma once
// PLACEHOLDER for the split into one file per kind (see the map module): the shapes every module relies on.

#include <cstdint>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "common/geometry/rigid3.h"
#include "common/geometry/similarity3.h"
#include "common/map/ids.h"
#include "common/map/keyframe.h"

namespace pangaea {

// A keyframe enters `map`. Without a parent it is the root of a new map and camera_from_parent is its camera_from_map.
struct AddKeyframe {
  KeyframeId id;
  MapId map;
  KeyframeId parent;
  Rigid3d camera_from_parent;
  std::shared_ptr<const KeyframeData> data;
};
struct TrackedFrame {
  KeyframeId reference;
  FramePose pose;
};
struct AddFramePoses {
  std::vector<TrackedFrame> frames;  // ascending by stamp
};
// A landmark and its first observation: a landmark is never without one.
struct AddLandmark {
  LandmarkId id;
  KeyframeId reference;
  std::uint32_t keypoint = 0;  // of the reference keyframe
  Eigen::Vector3d point_in_reference = Eigen::Vector3d::Zero();  // camera frame of the reference keyframe
};
struct AddObservation {
  LandmarkId landmark;
  KeyframeId keyframe;
  std::uint32_t keypoint = 0;
};
// Removing the last observation removes the landmark.
struct RemoveObservation {
  LandmarkId landmark;
  KeyframeId keyframe;
};
// Applied in the listed order, each against its parent's pose at that moment: list parents before children.
// Keyframes that are not listed keep their camera_from_map, landmarks their point_in_map.
struct MovedKeyframe {
  KeyframeId id;
  Rigid3d camera_from_parent;  // of a root: its camera_from_map
};
struct MoveKeyframes {
  std::vector<MovedKeyframe> keyframes;
};
struct MovedLandmark {
  LandmarkId id;
  Eigen::Vector3d point_in_reference;  // camera frame of the landmark's reference keyframe
};
struct MoveLandmarks {
  std::vector<MovedLandmark> landmarks;
};
struct FuseLandmarks {
  LandmarkId kept;
  LandmarkId absorbed;
};
struct RemoveKeyframe {
  KeyframeId id;
};
struct RemoveLandmark {
  LandmarkId id;
};
struct AddLoopEdge {
  KeyframeId from;
  KeyframeId to;
  Similarity3d to_from_from;  // camera frame of `from` to camera frame of `to`
};
struct MergeMaps {
  MapId survivor;
  MapId absorbed;
  Similarity3d survivor_from_absorbed;
  // The keyframe of the absorbed map that hangs below one of the survivor in the joined spanning tree.
  KeyframeId absorbed_attachment;
  KeyframeId survivor_attachment;
};
struct CloseMap {
  MapId map;
};

using MapEdit = std::variant<AddKeyframe, AddFramePoses, AddLandmark, AddObservation, RemoveObservation, MoveKeyframes,
                             MoveLandmarks, FuseLandmarks, RemoveKeyframe, RemoveLandmark, AddLoopEdge, MergeMaps,
                             CloseMap>;

}  // namespace pangaea
