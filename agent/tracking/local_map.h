#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "agent/tracking/template_store.h"
#include "common/map/atlas.h"
#include "common/mapping/observer_spread.h"

namespace pangaea {

struct LocalMapOptions {
  // Around the reference: enough to see what the camera may turn to within a second.
  std::size_t max_keyframes = 30;
};

// One view of a landmark that the current image can be compared with.
struct LandmarkView {
  const PatchTemplate* patch = nullptr;
  std::size_t pose = 0;  // index into LocalMap::view_poses
};

// Where a landmark was seen last: frames follow the corner that its keyframes saw, and the point, placed by all that
// ever took it for the same one, lies beside that (docs/decisions/0034-sightings.md).
struct Sighting {
  std::size_t pose = 0;                              // index into LocalMap::view_poses
  Eigen::Vector2d beside = Eigen::Vector2d::Zero();  // seen - projected, pixels of that keyframe
};

struct LocalLandmark {
  LandmarkId id;
  Eigen::Vector3d point_in_map = Eigen::Vector3d::Zero();
  ObserverSpread observers;
  // By the newest keyframe of the session that the templates are of; nothing where that saw it so far beside that it
  // may have seen something else.
  std::optional<Sighting> latest_sighting;
  int failures = 0;      // consecutive frames in which it was searched and not found
  bool tracked = false;  // in the latest frame
  int view_count = 0;
  std::array<LandmarkView, TemplateStore::kViewsPerLandmark> views;
};

// The landmarks that a frame near the reference keyframe may see, with their templates. Pointers lead into the store it
// was built from: it is rebuilt when that or the atlas changes.
struct LocalMap {
  std::vector<KeyframeId> keyframes;  // the reference first, then by covisibility
  // camera_from_map of the keyframes that templates were cut from, culled ones too, and of those of the sightings.
  std::vector<Rigid3d> view_poses;
  std::vector<LocalLandmark> landmarks;
};

// `previous` hands on which landmarks were tracked and how often they failed.
LocalMap CollectLocalMap(const Atlas& atlas, KeyframeId reference, const TemplateStore& templates,
                         const LocalMap& previous, const LocalMapOptions& options);

}  // namespace pangaea
