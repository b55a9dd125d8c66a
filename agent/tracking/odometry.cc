#include "agent/tracking/odometry.h"

namespace pangaea {

const OdometryState& Odometry::Update(const Rigid3d& camera_from_map,
                                      const std::optional<Rigid3d>& current_from_previous, double scale) {
  const Rigid3d body_from_camera = camera_from_body_.Inverse();
  const Rigid3d map_from_body = camera_from_map.Inverse() * camera_from_body_;
  state_.discontinuity = started_ && !current_from_previous;
  if (!started_) state_.odom_from_body = map_from_body;
  started_ = true;
  if (current_from_previous) {
    const Rigid3d motion(current_from_previous->rotation(), current_from_previous->translation() / scale);
    state_.odom_from_body = state_.odom_from_body * (body_from_camera * motion * camera_from_body_).Inverse();
  }
  // map_from_body = map_from_odom * odom_from_body, where lengths of the map are `scale` lengths of odom.
  const Eigen::Quaterniond map_from_odom = map_from_body.rotation() * state_.odom_from_body.rotation().conjugate();
  state_.map_from_odom =
      Similarity3d(scale, map_from_odom,
                   map_from_body.translation() - scale * (map_from_odom * state_.odom_from_body.translation()));
  return state_;
}

}  // namespace pangaea
