#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/map/atlas.h"
#include "common/mapping/view_prediction.h"

namespace pangaea {

// The landmarks of a map by where they lie, as they were when it was made: in cubes of space, so that a question looks
// at the cubes near a camera's pyramid of view and not at the whole map. Immutable.
class LandmarkIndex {
 public:
  // `edge` of a cube in map units, > 0.
  LandmarkIndex(const Atlas& atlas, MapId map, double edge);

  // Those in front of the viewpoint and inside its image, ascending.
  std::vector<LandmarkId> InView(const Viewpoint& viewpoint) const;

 private:
  struct Entry {
    LandmarkId id;
    Eigen::Vector3d point_in_map;
  };
  struct Cube {
    Eigen::Vector3d center_in_map;
    std::vector<Entry> landmarks;
  };

  double reach_;  // from the centre of a cube to its corners
  std::vector<Cube> cubes_;
};

}  // namespace pangaea
