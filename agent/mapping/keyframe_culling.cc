#include "agent/mapping/keyframe_culling.h"

#include <algorithm>

namespace pangaea {
namespace {

// Whether enough others than `keyframe` see the landmark at least as finely: one octave coarser is no loss.
bool SeenByOthers(const Atlas& atlas, const Landmark& landmark, const Keyframe& keyframe, int octave,
                  std::size_t others) {
  std::size_t count = 0;
  if (landmark.observations.size() <= others) return false;
  for (const Observation& observation : landmark.observations) {
    if (observation.keyframe == keyframe.id) continue;
    const Keyframe& observer = *atlas.FindKeyframe(observation.keyframe);
    if (observer.data->features.keypoints[observation.keypoint].octave <= octave + 1 && ++count >= others) return true;
  }
  return false;
}

bool IsRedundant(const Atlas& atlas, const Keyframe& keyframe, double max_depth,
                 const KeyframeCullingOptions& options) {
  std::size_t judged = 0;
  std::size_t redundant = 0;
  for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    if (!keyframe.landmarks[i].valid()) continue;
    const Landmark& landmark = *atlas.FindLandmark(keyframe.landmarks[i]);
    if (max_depth > 0.0 && (keyframe.camera_from_map * landmark.point_in_map).z() > max_depth) continue;
    ++judged;
    const int octave = keyframe.data->features.keypoints[i].octave;
    if (SeenByOthers(atlas, landmark, keyframe, octave, options.other_observers)) ++redundant;
  }
  return static_cast<double>(redundant) > options.redundant_ratio * static_cast<double>(judged);
}

}  // namespace

std::optional<KeyframeId> FindRedundantKeyframe(const Atlas& atlas, const Keyframe& newest,
                                                const std::vector<KeyframeId>& kept, double close_depth_baselines,
                                                const KeyframeCullingOptions& options) {
  for (const Covisibility& neighbour : newest.covisible) {
    const Keyframe& keyframe = *atlas.FindKeyframe(neighbour.keyframe);
    const bool own = keyframe.id.session == newest.id.session;
    if (!own || !keyframe.parent.valid() || keyframe.id.counter + options.newest_kept > newest.id.counter) continue;
    if (std::find(kept.begin(), kept.end(), keyframe.id) != kept.end()) continue;
    const double max_depth = close_depth_baselines * keyframe.data->camera.baseline;  // 0: monocular
    if (IsRedundant(atlas, keyframe, max_depth, options)) return keyframe.id;
  }
  return std::nullopt;
}

}  // namespace pangaea
