#include "agent/tracking/latest_frame.h"

#include "agent/tracking/resolved_pose.h"
#include "common/map/edits/reference_scale.h"

namespace pangaea {
namespace {

double Seconds(std::int64_t nanoseconds) { return 1e-9 * static_cast<double>(nanoseconds); }

}  // namespace

void LatestFrame::FollowScale(const Atlas& atlas) {
  const Keyframe* keyframe = atlas.FindKeyframe(atlas.Resolve(reference));
  if (keyframe == nullptr || keyframe->scale == scale) return;
  const double factor = keyframe->scale / scale;
  scale = keyframe->scale;
  reference_from_frame = ScaleLengths(reference_from_frame, factor);
  velocity.head<3>() *= factor;
  for (Eigen::Vector3d& point : points_in_camera) point *= factor;
}

std::optional<Rigid3d> LatestFrame::PoseIn(const Atlas& atlas) const {
  const auto reference_from_map = PoseOf(atlas, reference);
  if (!reference_from_map) return std::nullopt;
  return reference_from_frame.Inverse() * *reference_from_map;
}

Rigid3d LatestFrame::MotionUntil(std::int64_t later_ns) const {
  return Rigid3d::Exp(velocity * Seconds(later_ns - stamp_ns));
}

Vector6d LatestFrame::VelocityInto(std::int64_t later_ns, const Rigid3d& camera_from_map, MapId map,
                                   const Atlas& atlas) const {
  if (later_ns <= stamp_ns) return velocity;
  const auto pose = PoseIn(atlas);
  if (!pose || !IsInMap(atlas, reference, map)) return Vector6d::Zero();
  return (camera_from_map * pose->Inverse()).Log() / Seconds(later_ns - stamp_ns);
}

}  // namespace pangaea
