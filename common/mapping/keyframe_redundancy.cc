#include "common/mapping/keyframe_redundancy.h"

namespace pangaea {
namespace {

bool IsKnownWithout(const Atlas& atlas, const Landmark& landmark, KeyframeId without, int max_octave,
                    std::size_t others) {
  if (landmark.observations.size() <= others) return false;
  std::size_t count = 0;
  for (const Observation& observation : landmark.observations) {
    if (observation.keyframe == without) continue;
    const Keyframe& observer = *atlas.FindKeyframe(observation.keyframe);
    if (observer.data->features.keypoints[observation.keypoint].octave <= max_octave && ++count >= others) return true;
  }
  return false;
}

}  // namespace

double RedundantShare(const Atlas& atlas, const Keyframe& keyframe, const RedundancyCriterion& criterion) {
  std::size_t judged = 0;
  std::size_t known = 0;
  for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    if (!keyframe.landmarks[i].valid()) continue;
    const Landmark& landmark = *atlas.FindLandmark(keyframe.landmarks[i]);
    const double depth = (keyframe.camera_from_map * landmark.point_in_map).z();
    if (criterion.max_depth > 0.0 && depth > criterion.max_depth) continue;
    ++judged;
    const int octave = keyframe.data->features.keypoints[i].octave + criterion.coarser_octaves;
    known += IsKnownWithout(atlas, landmark, keyframe.id, octave, criterion.other_observers) ? 1 : 0;
  }
  return judged == 0 ? 0.0 : static_cast<double>(known) / static_cast<double>(judged);
}

}  // namespace pangaea
