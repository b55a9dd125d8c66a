#include "common/mapping/landmark_creation.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/geometry/triangulation.h"
#include "common/mapping/two_view_search.h"

namespace pangaea {
namespace {

struct StereoPoint {
  double depth = 0.0;
  std::uint32_t keypoint = 0;
};

// Keypoints with stereo depth and no landmark, the nearest first.
std::vector<StereoPoint> FreeStereoPoints(const Keyframe& keyframe) {
  const std::vector<Keypoint>& keypoints = keyframe.data->features.keypoints;
  const IdealCamera& camera = keyframe.data->camera;
  std::vector<StereoPoint> points;
  for (std::uint32_t i = 0; i < keypoints.size(); ++i) {
    const double disparity = keypoints[i].u - keypoints[i].u_right;
    if (!keypoints[i].has_depth() || keyframe.landmarks[i].valid() || disparity <= 0.0) continue;
    points.push_back({.depth = camera.focal_x * camera.baseline / disparity, .keypoint = i});
  }
  std::sort(points.begin(), points.end(), [](const StereoPoint& a, const StereoPoint& b) {
    return a.depth != b.depth ? a.depth < b.depth : a.keypoint < b.keypoint;
  });
  return points;
}

// Landmarks of the keyframe within `max_depth`.
std::size_t CountNear(const Atlas& atlas, const Keyframe& keyframe, double max_depth) {
  return static_cast<std::size_t>(
      std::count_if(keyframe.landmarks.begin(), keyframe.landmarks.end(), [&](LandmarkId id) {
        return id.valid() && (keyframe.camera_from_map * atlas.FindLandmark(id)->point_in_map).z() <= max_depth;
      }));
}

AddLandmark MakeLandmark(const Keyframe& keyframe, const StereoPoint& point, LandmarkId id) {
  const Keypoint& keypoint = keyframe.data->features.keypoints[point.keypoint];
  return {.id = id,
          .reference = keyframe.id,
          .keypoint = point.keypoint,
          .point_in_reference = point.depth * keyframe.data->camera.Unproject({keypoint.u, keypoint.v})};
}

}  // namespace

std::vector<MapEdit> CreateFromStereo(const Atlas& atlas, const Keyframe& keyframe, LandmarkId first_id,
                                      const LandmarkCreationOptions& options) {
  const double baseline = keyframe.data->camera.baseline;
  const bool first = !keyframe.parent.valid();
  const double close = options.close_depth_baselines * baseline;
  const double farthest = options.first_depth_baselines * baseline;
  std::size_t near = CountNear(atlas, keyframe, close);
  std::vector<MapEdit> edits;
  LandmarkId id = first_id;
  for (const StereoPoint& point : FreeStereoPoints(keyframe)) {
    if (point.depth > farthest) break;
    if (point.depth > close && !first && near >= options.min_close_landmarks) break;
    edits.push_back(MakeLandmark(keyframe, point, id));
    ++id.counter;
    ++near;
  }
  return edits;
}

std::vector<MapEdit> CreateByTriangulation(const Atlas& atlas, const Keyframe& keyframe,
                                           const std::vector<KeyframeId>& neighbours, LandmarkId first_id,
                                           const LandmarkCreationOptions& options,
                                           const MeasurementNoiseOptions& noise) {
  std::vector<bool> free(keyframe.landmarks.size());
  for (std::size_t i = 0; i < free.size(); ++i) free[i] = !keyframe.landmarks[i].valid();
  std::vector<MapEdit> edits;
  LandmarkId id = first_id;
  for (const KeyframeId neighbour_id : neighbours) {
    const Keyframe& neighbour = *atlas.FindKeyframe(neighbour_id);
    for (const TwoViewMatch& match : MatchAlongEpipolarLines(keyframe, neighbour, free, options, noise)) {
      const auto point_in_map = TriangulateMatch(keyframe, neighbour, match, options, noise);
      if (!point_in_map) continue;
      free[match.keypoint] = false;
      edits.push_back(AddLandmark{.id = id,
                                  .reference = keyframe.id,
                                  .keypoint = match.keypoint,
                                  .point_in_reference = keyframe.camera_from_map * *point_in_map});
      edits.push_back(AddObservation{.landmark = id, .keyframe = neighbour_id, .keypoint = match.other_keypoint});
      ++id.counter;
    }
  }
  return edits;
}

}  // namespace pangaea
