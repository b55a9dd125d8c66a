#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/geometry/ideal_camera.h"
#include "common/geometry/keypoint.h"
#include "common/geometry/rigid3.h"
#include "common/map/ids.h"

namespace pangaea {

// Where a keyframe's camera was when its frame was tracked, before any adjustment: what became of that since, the
// frames on the way to it share (common/map/frame_correction.h).
struct TrackedArrival {
  KeyframeId reference;  // that it was tracked against; none where it was not, as a map's first
  Rigid3d camera_from_reference;
  double reference_scale = 1.0;  // that the reference had then (Keyframe::scale)
  std::int64_t since_ns = 0;     // when its session had made the keyframe before
};

// What a keyframe saw. Nobody writes to it after its creation; SetVergence alone puts another in its place.
struct KeyframeData {
  std::int64_t stamp_ns = 0;
  IdealCamera camera;
  Features features;
  double vergence = 0.0;  // of the rig, radians, that the keypoints' u_right are for (common/geometry/vergence.h)
  TrackedArrival arrival = {};
};

// The pose of an ordinary frame, held by its reference keyframe so that later corrections move it.
struct FramePose {
  std::int64_t stamp_ns = 0;
  Rigid3d reference_from_frame;  // camera frame of the frame to camera frame of the reference keyframe
  // Whose frame it is, written by Apply from the reference it was added with: after culling, the keyframe that holds it
  // may be another session's. Not part of an edit.
  SessionId session = 0;
};

// The pose nearby that takes 24 bytes on the wire (others take 56): quantise frame poses where they are made, so that
// agent and server hold the same. Errors are below 1 µm and 1 µrad for motions of metres and below half a turn.
Rigid3d QuantizeFramePose(const Rigid3d& reference_from_frame);

// An edge of the covisibility graph: how many landmarks both keyframes observe.
struct Covisibility {
  KeyframeId keyframe;
  std::uint32_t weight = 0;
  bool operator==(const Covisibility&) const = default;
};

struct Keyframe {
  KeyframeId id;
  MapId map;
  // Shared and const: a snapshot handed to a reader stays valid after the owner culls the keyframe.
  std::shared_ptr<const KeyframeData> data;
  Rigid3d camera_from_map;
  // The newest correction of the server that placed it (the position of its edit in the journal); 0: none did. From the
  // first one on the server alone moves it: moves of its agent that are still under way change nothing.
  std::uint64_t corrected_at = 0;
  // By how much corrections have multiplied the lengths around it since its agent measured them. Other than 1 only
  // where a map without scale got one, or its scale drifted.
  double scale = 1.0;
  KeyframeId parent;                 // in the spanning tree; none for the root of a map
  std::vector<KeyframeId> children;  // in the spanning tree, ascending
  // The landmark each keypoint observes; none where it observes none. As long as data->features.keypoints.
  std::vector<LandmarkId> landmarks;
  std::vector<Covisibility> covisible;  // ascending by keyframe id; kept by Apply, never sent
  // Frames tracked against this keyframe, ascending by stamp. Shared and const: most edits leave it alone. nullptr
  // where there are none.
  std::shared_ptr<const std::vector<FramePose>> frames;
};

}  // namespace pangaea
