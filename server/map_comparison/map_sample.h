#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/descriptor.h"
#include "common/map/atlas.h"
#include "server/map_comparison/map_comparison_options.h"

namespace pangaea {

// What of a map is compared with other maps: landmarks that were seen often enough, of a large map every so many, so
// that they are spread like all of them. Index by index, in the order of their ids.
struct MapSample {
  MapId map;
  double depth = 1.0;  // the median distance of the map's landmarks from their cameras
  std::vector<LandmarkId> landmarks;
  std::vector<Eigen::Vector3d> points;  // in the frame of the map
  // That of the sighting which differs least from the other sightings of the landmark.
  std::vector<Descriptor> descriptors;
};

MapSample SampleMap(const Atlas& atlas, MapId map, const MapComparisonOptions& options);

}  // namespace pangaea
