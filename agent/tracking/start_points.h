#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <span>

#include "agent/tracking/initial_tracks.h"
#include "common/geometry/ideal_camera.h"
#include "common/geometry/rigid3.h"

namespace pangaea {

// A point of a map that is about to begin.
struct StartPoint {
  Eigen::Vector3d point_in_first;  // camera frame of the first frame
  Eigen::Vector2d first_pixel;     // where the first frame sees it
  double sigma = 1.0;              // of first_pixel
};
// By the keypoint of the first frame.
using StartPoints = std::map<std::uint32_t, StartPoint>;

// Another frame that sees the points.
struct StartView {
  Rigid3d frame_from_first;
  std::span<const InitialTrack> tracks;
};

// A frame's pose on the points, from a first guess. Nothing with fewer than `min_inliers`, or where less than half of
// what the frame sees agrees.
std::optional<Rigid3d> LocateOnPoints(const IdealCamera& camera, const StartPoints& points,
                                      std::span<const InitialTrack> tracks, const Rigid3d& guess_frame_from_first,
                                      int min_inliers);

// Adjusts points and views together on all that the first frame and the views see. Points that the first frame or the
// last view do not see there go. Afterwards the median depth of the points is
// `median_depth`.
void AdjustStart(const IdealCamera& camera, double median_depth, StartPoints& points, std::span<StartView> views);

}  // namespace pangaea
