#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/simulation/texture.h"

namespace pangaea {

// A textured parallelogram in the world: point(s, t) = corner + s * along + t * across, s and t in [0, 1]. Seen only
// from the side from which it looks like a picture: along to the right, across downwards (along x across points away
// from the viewer). (s, t) = (0, 0) is the outer corner of the texture's texel (0, 0).
struct Surface {
  Eigen::Vector3d corner;
  Eigen::Vector3d along;
  Eigen::Vector3d across;
  std::shared_ptr<const Texture> texture;  // never null in a scene that is rendered
};

// A solid that a flight must keep away from and that casts shadows: a box turned about the vertical.
struct Solid {
  Eigen::Vector3d center;
  Eigen::Vector3d half_size;
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();  // unit vector of its own x axis, seen from above

  // From world axes to the solid's own.
  Eigen::Vector3d ToLocal(const Eigen::Vector3d& v) const {
    return {axis.x() * v.x() + axis.y() * v.y(), axis.x() * v.y() - axis.y() * v.x(), v.z()};
  }
  // Negative inside. Exact outside.
  double Distance(const Eigen::Vector3d& point) const;
};

// A figure that walks round the hall and gives way to the camera.
struct Occluder {
  std::vector<Surface> surfaces;  // about its own foot point
  double phase = 0.0;             // of its round, in turns
  double radius_x = 0.0;          // of its round about the middle of the hall, metres
  double radius_y = 0.0;
  double period = 1.0;  // seconds a round; negative the other way

  // Adds its surfaces as they are at `seconds`, out of arm's reach of a body at `body_in_world`.
  void AppendSurfaces(double seconds, const Eigen::Vector3d& body_in_world, std::vector<Surface>& surfaces_out) const;
};

// What the cameras look at. World frame: z up, origin in the middle of the floor.
struct Scene {
  Eigen::Vector3d half_size;  // of the room: |x| <= half_size.x, |y| <= half_size.y, 0 <= z <= 2 * half_size.z
  std::vector<Surface> surfaces;
  std::vector<Solid> solids;
  std::vector<Occluder> occluders;

  // Distance from a point of the room to the nearest wall or solid, metres.
  double Clearance(const Eigen::Vector3d& point) const;
};

}  // namespace pangaea
