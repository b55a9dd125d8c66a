#include "common/mapping/view_overlap.h"

#include <algorithm>
#include <vector>

namespace pangaea {

double VisibleShare(const Atlas& atlas, const Keyframe& keyframe, const Viewpoint& viewpoint, std::size_t samples) {
  std::vector<LandmarkId> seen;
  for (const LandmarkId id : keyframe.landmarks) {
    if (id.valid()) seen.push_back(id);
  }
  const std::size_t stride = std::max<std::size_t>(1, seen.size() / samples);
  int tried = 0;
  int visible = 0;
  for (std::size_t i = 0; i < seen.size(); i += stride) {
    const Eigen::Vector3d point = viewpoint.camera_from_map * atlas.FindLandmark(seen[i])->point_in_map;
    ++tried;
    if (point.z() > 0.0 && viewpoint.camera.Contains(viewpoint.camera.Project(point))) ++visible;
  }
  return tried == 0 ? 0.0 : static_cast<double>(visible) / tried;
}

}  // namespace pangaea
