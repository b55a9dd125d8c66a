#include "common/map/keyframe_vergence.h"

#include "common/geometry/vergence.h"

namespace pangaea {

std::shared_ptr<const KeyframeData> WithVergence(std::shared_ptr<const KeyframeData> data, double vergence) {
  if (data->vergence == vergence || !data->camera.is_stereo()) return data;
  auto turned = std::make_shared<KeyframeData>(*data);
  turned->vergence = vergence;
  for (Keypoint& keypoint : turned->features.keypoints) {
    if (!keypoint.has_depth()) continue;
    // Each shift is rounded by itself: then they add up exactly, whichever way the vergence came about.
    const auto shift_at = [&](double angle) { return QuantizePixel(VergenceShift(data->camera, keypoint.u, angle)); };
    const float u_right = keypoint.u_right + shift_at(data->vergence) - shift_at(vergence);
    keypoint.u_right = u_right >= 0.0F && u_right < keypoint.u ? u_right : -1.0F;
  }
  return turned;
}

double VergenceOf(const Atlas& atlas, SessionId session) {
  double vergence = 0.0;
  atlas.ForEachKeyframe(session, [&](const Keyframe& keyframe) { vergence = keyframe.data->vergence; });
  return vergence;
}

}  // namespace pangaea
