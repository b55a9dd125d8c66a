#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/map/atlas.h"
#include "common/mapping/view_prediction.h"

namespace pangaea {

struct PlacedLandmark {
  LandmarkId id;
  Eigen::Vector3d point_in_map;
};

struct PlaceInView {
  std::uint32_t place;
  Eigen::Vector2d pixel;
};

// Landmarks of a map by where they lie, as they were when it was made: in cubes of space, so that a question looks at
// the cubes near a camera's pyramid of view and not at the whole map. Immutable.
class LandmarkIndex {
 public:
  // Of all landmarks of the map. `edge` of a cube in map units, > 0.
  LandmarkIndex(const Atlas& atlas, MapId map, double edge);
  // Of these.
  LandmarkIndex(const std::vector<PlacedLandmark>& landmarks, double edge);

  // Those in front of the viewpoint and inside its image, ascending.
  std::vector<LandmarkId> InView(const Viewpoint& viewpoint) const;
  // The same with their pixels, as places in landmarks().
  std::vector<PlaceInView> PlacesInView(const Viewpoint& viewpoint) const;
  // All of them, those of a cube together.
  const std::vector<PlacedLandmark>& landmarks() const { return landmarks_; }

 private:
  struct Cube {
    Eigen::Vector3d center_in_map;
    std::size_t end = 0;  // of its landmarks; they begin where those of the cube before it end
  };
  template <typename Visit>
  void VisitInView(const Viewpoint& viewpoint, const Visit& visit) const;

  double reach_;  // from the centre of a cube to its corners
  std::vector<Cube> cubes_;
  std::vector<PlacedLandmark> landmarks_;
};

}  // namespace pangaea
