#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/rigid3.h"
#include "common/map/edits/edits.h"
#include "common/map/ids.h"
#include "common/mapping/landmark_creation_options.h"
#include "common/mapping/landmark_search.h"
#include "common/mapping/measurement_noise.h"

namespace pangaea {

// A keyframe whose pose somebody else measured.
struct PosedKeyframe {
  std::shared_ptr<const KeyframeData> data;
  Rigid3d world_from_camera;  // metres
};

struct PosedMapOptions {
  MeasurementNoiseOptions noise;
  LandmarkSearchOptions search;
  LandmarkCreationOptions creation;
  // Earlier keyframes that look at the same are searched when they see at least this part of a keyframe's landmarks
  // (of so many of them), those with most first.
  double min_overlap = 0.2;
  std::size_t overlap_samples = 40;
  // The keyframes before it that are tried whatever they see: without stereo nothing else begins a map (count).
  std::size_t latest = 3;
  // Steps of the final adjustment of the points, with all observations and then without the outliers these showed.
  int iterations = 10;
  int iterations_without_outliers = 5;

  // Says which option is out of which range.
  Status Check() const;
};

struct PosedMap {
  std::vector<MapEdit> edits;  // that make the map, and close it
  // Of the observations of landmarks that several keyframes see, in standard deviations of a keypoint: above 1 or so
  // the poses do not fit the images. 0 where there are none.
  double median_error = 0.0;
};

// One map of keyframes that are where they are said to be, numbered as they come: landmarks from stereo depth and from
// matches along the epipolar lines between keyframes that look at the same, each judged by parallax and reprojection,
// looked for in the other keyframes, fused, and adjusted with the poses held. The first keyframe's camera is the map's
// origin. At least one keyframe; `options` have passed Check().
PosedMap BuildPosedMap(SessionId session, std::span<const PosedKeyframe> keyframes, const PosedMapOptions& options);

}  // namespace pangaea
