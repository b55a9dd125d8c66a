#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "common/base/descriptor.h"
#include "common/features/feature_grid.h"
#include "common/geometry/keypoint.h"
#include "common/geometry/rigid3.h"
#include "common/map/atlas.h"

namespace pangaea {

// A keyframe through which a landmark is known.
struct PlaceObserver {
  KeyframeId id;
  std::shared_ptr<const KeyframeData> data;
  Rigid3d camera_from_center;
  Eigen::Vector3d position;  // of its camera, in the frame of the central one
};

// Which keypoint of which observer shows a landmark.
struct PlaceSighting {
  std::uint32_t observer = 0;  // index into the observers
  std::uint32_t keypoint = 0;
};

struct PlaceLandmark {
  LandmarkId id;
  Eigen::Vector3d point;  // in the camera frame of the central keyframe, lengths of its map
  PlaceSighting first;    // by the first of the observers that saw it
  PlaceSighting far;      // by the one farthest from the central camera: it tells the distance
};

// What a keyframe and its best covisible ones know of a place, in the camera frame of that central keyframe. A value of
// its own: it stays what it is when the atlas changes.
struct PlaceView {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  MapId map;
  std::vector<PlaceObserver> observers;    // the central one first
  std::vector<PlaceLandmark> landmarks;    // each once, those that the central keyframe sees first
  std::vector<Keypoint> keypoints;         // by landmark: where its first observer saw it
  std::vector<Descriptor> descriptors;     // by landmark: what it looked like there
  std::size_t central = 0;                 // landmarks of the central keyframe
  std::vector<std::uint32_t> landmark_at;  // by keypoint of the central keyframe; kNone where there is none
  FeatureGrid grid;                        // of the central keyframe's keypoints

  const PlaceObserver& center() const { return observers.front(); }
};

// The keypoints of a keyframe that show a landmark, in order: how the first landmarks of its PlaceView look. Far
// cheaper than that, since no landmark is looked up.
struct LandmarkAppearances {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
};
LandmarkAppearances OwnAppearances(const Keyframe& keyframe);

// What these keyframes of one map know; all are alive in the atlas, the first one is central.
PlaceView MakePlaceView(const Atlas& atlas, std::span<const KeyframeId> keyframes);
// With the landmarks of the `covisible` best covisible keyframes.
PlaceView MakePlaceView(const Atlas& atlas, const Keyframe& keyframe, std::size_t covisible);

}  // namespace pangaea
