#include "common/map/forgetting.h"

#include <algorithm>

#include "common/map/atlas_editor.h"

namespace pangaea {
namespace {

bool SameFrames(const std::vector<FramePose>& a, const std::vector<FramePose>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const FramePose& x, const FramePose& y) {
    return x.stamp_ns == y.stamp_ns && x.session == y.session &&
           x.reference_from_frame.rotation().coeffs() == y.reference_from_frame.rotation().coeffs() &&
           x.reference_from_frame.translation() == y.reference_from_frame.translation();
  });
}

}  // namespace

bool IsForgotten(const Keyframe& keyframe) { return keyframe.data->features.keypoints.empty(); }

void Forget(Atlas& atlas, std::span<const ForgottenKeyframe> keyframes) {
  AtlasEditor editor(atlas);
  bool changed = false;
  for (const auto& [id, frames] : keyframes) {
    const Keyframe* keyframe = atlas.FindKeyframe(id);
    if (keyframe == nullptr || IsForgotten(*keyframe)) continue;
    changed = true;
    editor.ForgetKeyframe(id);
    Keyframe& written = editor.WriteKeyframe(id);
    const bool shared = frames != nullptr && written.frames != nullptr && SameFrames(*frames, *written.frames);
    if (shared) written.frames = frames;
  }
  if (!changed) return;
  editor.DropFormerLandmarks();
  editor.SetVersion(atlas.version() + 1);
}

void ShareFrames(Atlas& atlas, const Atlas& twin) {
  std::vector<KeyframeId> same;
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    const Keyframe* other = twin.FindKeyframe(keyframe.id);
    if (other == nullptr || other->frames == nullptr || keyframe.frames == nullptr) return;
    if (other->frames != keyframe.frames && SameFrames(*other->frames, *keyframe.frames)) same.push_back(keyframe.id);
  });
  AtlasEditor editor(atlas);
  for (const KeyframeId id : same) editor.WriteKeyframe(id).frames = twin.FindKeyframe(id)->frames;
}

}  // namespace pangaea
