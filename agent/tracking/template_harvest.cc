#include "agent/tracking/template_harvest.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pangaea {
namespace {

// Unit vector from the landmark to the camera of a keyframe, in map axes; zero when the keyframe is unknown.
Eigen::Vector3d DirectionFrom(const Atlas& atlas, const Landmark& landmark, KeyframeId id) {
  const auto resolved = atlas.ResolvePose(id);
  if (!resolved) return Eigen::Vector3d::Zero();
  const Rigid3d camera_from_map = resolved->keyframe_from_asked.Inverse() * resolved->keyframe->camera_from_map;
  return (camera_from_map.Inverse().translation() - landmark.point_in_map).normalized();
}

bool NeedsView(const Atlas& atlas, const Landmark& landmark, KeyframeId id, double new_view_cosine,
               const TemplateStore& templates) {
  const auto views = templates.Find(landmark.id);
  if (views.empty()) return true;
  if (std::ranges::any_of(views, [id](const PatchTemplate& view) { return view.keyframe == id; })) return false;
  const Eigen::Vector3d direction = DirectionFrom(atlas, landmark, id);
  return std::none_of(views.begin(), views.end(), [&](const PatchTemplate& view) {
    return DirectionFrom(atlas, landmark, view.keyframe).dot(direction) > new_view_cosine;
  });
}

}  // namespace

void HarvestTemplates(const Atlas& atlas, KeyframeId id, const ImagePyramid& image, double new_view_angle,
                      TemplateStore& templates) {
  const Keyframe* keyframe = atlas.FindKeyframe(id);
  if (keyframe == nullptr) return;
  const double new_view_cosine = std::cos(new_view_angle * std::numbers::pi / 180.0);
  for (std::size_t i = 0; i < keyframe->landmarks.size(); ++i) {
    if (!keyframe->landmarks[i].valid()) continue;
    const Landmark& landmark = *atlas.FindLandmark(keyframe->landmarks[i]);
    if (!NeedsView(atlas, landmark, id, new_view_cosine, templates)) continue;
    const Keypoint& keypoint = keyframe->data->features.keypoints[i];
    const auto view = CutTemplate(image, id, {keypoint.u, keypoint.v}, keypoint.octave);
    if (view) templates.Add(landmark.id, *view);
  }
}

}  // namespace pangaea
