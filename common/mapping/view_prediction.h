#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/features/matching.h"
#include "common/geometry/ideal_camera.h"
#include "common/geometry/rigid3.h"
#include "common/map/atlas.h"

namespace pangaea {

// Where something is looked for: a camera at an assumed pose in the map.
struct Viewpoint {
  Viewpoint(const IdealCamera& ideal_camera, const Rigid3d& pose)
      : camera(ideal_camera), camera_from_map(pose), center_in_map(pose.Inverse().translation()) {}
  explicit Viewpoint(const Keyframe& keyframe) : Viewpoint(keyframe.data->camera, keyframe.camera_from_map) {}

  IdealCamera camera;
  Rigid3d camera_from_map;
  Eigen::Vector3d center_in_map;
};

// How a landmark should look from a viewpoint.
struct PredictedView {
  Eigen::Vector3d measurement;  // ideal pixel (u, v, u_right); u_right < 0 where the camera has no right image
  double depth = 0.0;           // map units
  int octave = 0;               // on which its patch has the size that it had in `nearest`
  Observation nearest;          // the observation seen from the direction nearest to the new one
};

// Nothing when the landmark is behind the camera, outside the image, or was only seen from directions more than
// `max_view_angle` (degrees) away.
std::optional<PredictedView> PredictView(const Atlas& atlas, const Landmark& landmark, const Viewpoint& viewpoint,
                                         double max_view_angle);

// On which octave a patch has the size that it had on `octave` at `distance`, seen from `new_distance`. One step
// outside of the octaves where it is out of their range.
int PredictOctave(int octave, double distance, double new_distance);

// Looks there, within `radius` pixels of the octave and on octaves up to `octave_tolerance` from the predicted one, for
// what the landmark looked like in the nearest view.
ProjectionQuery MakeProjectionQuery(const Atlas& atlas, const PredictedView& view, double radius, int octave_tolerance);

}  // namespace pangaea
