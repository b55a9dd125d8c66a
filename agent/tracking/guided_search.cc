#include "agent/tracking/guided_search.h"

namespace pangaea {

std::optional<LocatedFrame> LocateByDescriptors(const IdealCamera& camera, const Features& features, const Atlas& atlas,
                                                const Rigid3d& rough_camera_from_map, const LocalMap& local_map,
                                                const GuidedSearchOptions& options) {
  std::vector<SoughtLandmark> sought;
  sought.reserve(local_map.landmarks.size());
  for (const LocalLandmark& landmark : local_map.landmarks) sought.push_back({landmark.id, landmark.observers});
  const auto location = LocateByDescriptors(camera, features, atlas, rough_camera_from_map, sought, options);
  if (!location) return std::nullopt;
  LocatedFrame frame{location->pose, {}, location->searched, location->found};
  for (const GuidedMatch& found : location->matches) {
    const Keypoint& keypoint = features.keypoints[found.keypoint];
    LandmarkMatch match;
    match.landmark = static_cast<int>(found.landmark);
    match.pixel = {keypoint.u, keypoint.v};
    match.octave = keypoint.octave;
    match.sigma = found.sigma;
    frame.matches.push_back(match);
  }
  return frame;
}

}  // namespace pangaea
