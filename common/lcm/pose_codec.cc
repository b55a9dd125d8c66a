#include "common/lcm/pose_codec.h"

#include <algorithm>
#include <cmath>

namespace pangaea {
namespace {

constexpr double kUnitTolerance = 1e-3;  // of the quaternion's length

}  // namespace

pangaea_lcm::rigid_pose_t PoseMessage(const Rigid3d& pose) {
  pangaea_lcm::rigid_pose_t message{};
  std::copy_n(pose.translation().data(), 3, message.position);
  const Eigen::Quaterniond& q = pose.rotation();
  const double rotation[4] = {q.w(), q.x(), q.y(), q.z()};
  std::ranges::copy(rotation, message.rotation);
  return message;
}

std::optional<Rigid3d> RigidOf(const pangaea_lcm::rigid_pose_t& message) {
  const double* r = message.rotation;
  const Eigen::Quaterniond rotation(r[0], r[1], r[2], r[3]);
  const Eigen::Vector3d position(message.position[0], message.position[1], message.position[2]);
  if (!position.allFinite() || !(std::abs(rotation.norm() - 1.0) < kUnitTolerance)) return std::nullopt;
  if (const auto exact = Rigid3d::FromNormalized(rotation, position)) return exact;
  return Rigid3d(rotation, position);
}

}  // namespace pangaea
