#include "server/fusion/landmark_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "common/map/id_set.h"

namespace pangaea {
namespace {

// The pyramid of what a camera has in view, in its own frame: its four sides, as normals that point inwards.
class ViewPyramid {
 public:
  explicit ViewPyramid(const IdealCamera& camera) {
    const Eigen::Vector3d low = camera.Unproject({0.0, 0.0});
    const Eigen::Vector3d high = camera.Unproject({camera.width, camera.height});
    inward_ = {Eigen::Vector3d(1.0, 0.0, -low.x()), Eigen::Vector3d(-1.0, 0.0, high.x()),
               Eigen::Vector3d(0.0, 1.0, -low.y()), Eigen::Vector3d(0.0, -1.0, high.y())};
    for (Eigen::Vector3d& normal : inward_) normal.normalize();
  }

  // Whether a ball may reach into it.
  bool Touches(const Eigen::Vector3d& center_in_camera, double radius) const {
    return center_in_camera.z() > -radius &&
           std::ranges::all_of(inward_, [&](const auto& normal) { return normal.dot(center_in_camera) > -radius; });
  }

 private:
  std::array<Eigen::Vector3d, 4> inward_;
};

std::array<std::int64_t, 3> CubeOf(const Eigen::Vector3d& point_in_map, double edge) {
  std::array<std::int64_t, 3> cube{};
  for (Eigen::Index i = 0; i < 3; ++i) {
    cube[static_cast<std::size_t>(i)] = static_cast<std::int64_t>(std::floor(point_in_map[i] / edge));
  }
  return cube;
}

std::vector<PlacedLandmark> LandmarksOf(const Atlas& atlas, MapId map) {
  std::vector<PlacedLandmark> landmarks;
  atlas.ForEachLandmark([&](const Landmark& landmark) {
    if (atlas.MapOf(landmark) == map) landmarks.push_back({landmark.id, landmark.point_in_map});
  });
  return landmarks;
}

}  // namespace

LandmarkIndex::LandmarkIndex(const Atlas& atlas, MapId map, double edge)
    : LandmarkIndex(LandmarksOf(atlas, map), edge) {}

LandmarkIndex::LandmarkIndex(const std::vector<PlacedLandmark>& landmarks, double edge)
    : reach_(edge * std::sqrt(0.75)) {
  std::map<std::array<std::int64_t, 3>, std::vector<PlacedLandmark>> cubes;
  for (const PlacedLandmark& landmark : landmarks) cubes[CubeOf(landmark.point_in_map, edge)].push_back(landmark);
  landmarks_.reserve(landmarks.size());
  for (const auto& [cube, inside] : cubes) {
    landmarks_.insert(landmarks_.end(), inside.begin(), inside.end());
    const Eigen::Vector3d corner(static_cast<double>(cube[0]), static_cast<double>(cube[1]),
                                 static_cast<double>(cube[2]));
    cubes_.push_back({edge * (corner + Eigen::Vector3d::Constant(0.5)), landmarks_.size()});
  }
}

template <typename Visit>
void LandmarkIndex::VisitInView(const Viewpoint& viewpoint, const Visit& visit) const {
  const ViewPyramid pyramid(viewpoint.camera);
  const Eigen::Matrix3d rotation = viewpoint.camera_from_map.rotation().toRotationMatrix();
  const Eigen::Vector3d translation = viewpoint.camera_from_map.translation();
  std::size_t place = 0;
  for (const Cube& cube : cubes_) {
    if (!pyramid.Touches(rotation * cube.center_in_map + translation, reach_)) place = cube.end;
    for (; place < cube.end; ++place) {
      const Eigen::Vector3d point = rotation * landmarks_[place].point_in_map + translation;
      if (point.z() <= 0.0) continue;
      const Eigen::Vector2d pixel = viewpoint.camera.Project(point);
      if (viewpoint.camera.Contains(pixel)) visit(place, pixel);
    }
  }
}

std::vector<LandmarkId> LandmarkIndex::InView(const Viewpoint& viewpoint) const {
  LandmarkIdSet seen;
  VisitInView(viewpoint, [&](std::size_t place, const Eigen::Vector2d&) { seen.Insert(landmarks_[place].id); });
  return seen.Ascending();
}

std::vector<PlaceInView> LandmarkIndex::PlacesInView(const Viewpoint& viewpoint) const {
  std::vector<PlaceInView> places;
  VisitInView(viewpoint, [&places](std::size_t place, const Eigen::Vector2d& pixel) {
    places.push_back({static_cast<std::uint32_t>(place), pixel});
  });
  return places;
}

}  // namespace pangaea
