#include "agent/tracking/recent_keyframes.h"

#include "agent/tracking/resolved_pose.h"
#include "agent/tracking/template_harvest.h"
#include "common/map/edits/reference_scale.h"

namespace pangaea {

void RecentKeyframes::Add(KeyframeId id, const ImagePyramid& image, KeyframeId reference,
                          const Rigid3d& camera_from_reference, ReferenceScale scale) {
  keyframes_.push_back(Recent{id, CopyPyramid(image), reference, camera_from_reference, scale});
  if (keyframes_.size() > most_) keyframes_.pop_front();
}

bool RecentKeyframes::IsOneUnderWay(const Atlas& atlas) const {
  return !keyframes_.empty() && !atlas.Knows(keyframes_.back().id);
}

KeyframeId RecentKeyframes::NewestTrackedAgainst(KeyframeId reference, const Atlas& atlas) const {
  if (keyframes_.empty() || keyframes_.back().reference != reference) return {};
  return atlas.Resolve(keyframes_.back().id);
}

std::vector<Rigid3d> RecentKeyframes::PosesUnderWay(const Atlas& atlas) const {
  std::vector<Rigid3d> poses;
  for (const Recent& recent : keyframes_) {
    if (atlas.Knows(recent.id)) continue;
    if (const auto pose = PoseUnderWay(recent, atlas)) poses.push_back(*pose);
  }
  return poses;
}

void RecentKeyframes::Harvest(const Atlas& atlas, double new_view_angle, TemplateStore& templates) const {
  for (const Recent& recent : keyframes_) HarvestTemplates(atlas, recent.id, recent.image, new_view_angle, templates);
}

std::optional<RecentKeyframes::Place> RecentKeyframes::NewestIn(MapId map, SessionId session,
                                                                const Atlas& atlas) const {
  for (auto recent = keyframes_.rbegin(); recent != keyframes_.rend(); ++recent) {
    const KeyframeId known = atlas.Resolve(recent->id);
    if (!IsInMap(atlas, known.valid() ? known : recent->reference, map)) continue;
    const auto pose = known.valid() ? PoseOf(atlas, known) : PoseUnderWay(*recent, atlas);
    if (!pose || (known.valid() && known.session != session)) continue;
    if (!known.valid()) return Place{recent->id, *pose, std::nullopt};
    return Place{known, *pose, ReferenceScale{atlas.FindKeyframe(known)->scale}};
  }
  return std::nullopt;
}

// Nothing where its reference is on its way, too.
std::optional<Rigid3d> RecentKeyframes::PoseUnderWay(const Recent& recent, const Atlas& atlas) {
  const auto reference_from_map = PoseOf(atlas, recent.reference);
  if (!reference_from_map) return std::nullopt;
  const Keyframe& reference = *atlas.FindKeyframe(atlas.Resolve(recent.reference));
  return ScaleLengths(recent.camera_from_reference, LengthFactor(reference, recent.scale)) * *reference_from_map;
}

}  // namespace pangaea
