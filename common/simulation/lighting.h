#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/simulation/material.h"
#include "common/simulation/scene.h"

namespace pangaea {

// Fixed lamps, their shadows, and a darkening of corners and crevices: enough to look like a place.
class Lighting {
 public:
  // Small solids neither cast shadows nor darken: nobody would see it, and the hall is ready sooner.
  Lighting(const Scene& scene, std::vector<Eigen::Vector3d> lamps);

  // For the whole of a surface, samples about `spacing` metres apart.
  LightGrid Light(const Surface& surface, double spacing) const;

 private:
  float At(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
  double Openness(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
  bool Sees(const Eigen::Vector3d& point, const Eigen::Vector3d& lamp) const;

  Scene large_solids_;  // the room and its large solids, without surfaces
  std::vector<Eigen::Vector3d> lamps_;
};

}  // namespace pangaea
