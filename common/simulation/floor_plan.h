#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/simulation/material.h"
#include "common/simulation/random.h"
#include "common/simulation/scene.h"

namespace pangaea {

// A surface before it is painted.
struct PlannedSurface {
  Surface surface;  // without texture
  Material material;
  double texel;          // metres
  bool glowing = false;  // not lit by the lamps
};

// What the hall consists of, before anything is painted.
struct FloorPlan {
  Scene scene;  // without surfaces
  std::vector<PlannedSurface> surfaces;
  std::vector<Eigen::Vector3d> lamps;

  // A rectangle of width x height seen from the side `normal` points to, `up` (perpendicular to it) upwards.
  void AddRectangle(const Eigen::Vector3d& center, const Eigen::Vector3d& normal, const Eigen::Vector3d& up,
                    double width, double height, Material material, double texel);
  // A solid box and its faces. One that stands on something shows no face below.
  void AddBox(const Eigen::Vector3d& center, const Eigen::Vector3d& half_size, double yaw, Material material,
              bool shows_bottom = false);
};

// The hall's room and furniture, arranged by chance.
FloorPlan PlanHall(std::uint64_t seed);

// The faces of one upright box, standing on the origin of its own plan.
FloorPlan PlanOccluder(std::uint64_t seed);

}  // namespace pangaea
