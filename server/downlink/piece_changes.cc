#include "server/downlink/piece_changes.h"

#include <algorithm>

namespace pangaea {
namespace {

// Positions that differ by less, relatively, are the same: they were taken apart and composed again.
constexpr double kSame = 1e-7;

bool Follows(const Atlas& atlas, const Landmark& now, const Atlas& before_atlas, const Landmark& before) {
  if (now.reference != before.reference) return false;
  const Keyframe* reference = before_atlas.FindKeyframe(before.reference);
  if (reference == nullptr) return false;
  const Eigen::Vector3d was = reference->camera_from_map * before.point_in_map;
  const Eigen::Vector3d is = atlas.FindKeyframe(now.reference)->camera_from_map * now.point_in_map;
  return (was - is).norm() <= kSame * std::max(1.0, was.norm());
}

bool IsAsKnown(const Atlas& atlas, const Landmark& landmark, const KnownState& known) {
  if (known.atlas == nullptr) return false;
  const Landmark* before = known.atlas->FindLandmark(landmark.id);
  return before != nullptr && before->observations == landmark.observations &&
         Follows(atlas, landmark, *known.atlas, *before);
}

// Landmarks that live, that a keyframe was known to observe and that it does not observe any more.
void AddLost(const Atlas& atlas, const Atlas& before, const Keyframe& keyframe, std::set<LandmarkId>& changed) {
  const Keyframe* known = before.FindKeyframe(keyframe.id);
  if (known == nullptr) return;
  for (std::size_t i = 0; i < known->landmarks.size(); ++i) {
    const LandmarkId landmark = known->landmarks[i];
    if (!landmark.valid() || keyframe.landmarks[i] == landmark) continue;
    if (atlas.FindLandmark(landmark) != nullptr) changed.insert(landmark);
  }
}

}  // namespace

std::vector<LandmarkId> ChangedLandmarks(const Atlas& atlas, const KnownState& known,
                                         const std::vector<KeyframeId>& keyframes, const std::set<KeyframeId>& fresh) {
  std::set<LandmarkId> changed;
  std::set<LandmarkId> seen;
  for (const KeyframeId id : keyframes) {
    const Keyframe& keyframe = *atlas.FindKeyframe(id);
    const bool all = fresh.contains(id);
    if (!all && known.atlas == nullptr && keyframe.corrected_at <= known.version) continue;
    for (const LandmarkId landmark : keyframe.landmarks) {
      if (!landmark.valid() || changed.contains(landmark)) continue;
      if (!all && !seen.insert(landmark).second) continue;
      if (all || !IsAsKnown(atlas, *atlas.FindLandmark(landmark), known)) changed.insert(landmark);
    }
    if (!all && known.atlas != nullptr) AddLost(atlas, *known.atlas, keyframe, changed);
  }
  return {changed.begin(), changed.end()};
}

std::vector<LandmarkId> FormerLandmarks(const Atlas& atlas, const KnownState& known, SessionId session) {
  std::vector<LandmarkId> former;
  atlas.ForEachFormerLandmark([&](LandmarkId id, LandmarkId) {
    const bool lived = known.atlas != nullptr && known.atlas->FindLandmark(id) != nullptr;
    const bool is_news = known.atlas == nullptr || !known.atlas->Knows(id);
    if (lived || (is_news && id.session == session)) former.push_back(id);
  });
  return former;
}

std::vector<KeyframeId> GoneKeyframes(const Atlas& atlas, const KnownState& known, SessionId session,
                                      const std::vector<KeyframeId>& held) {
  std::vector<KeyframeId> gone;
  atlas.ForEachFormerKeyframe([&](KeyframeId id, const CulledKeyframe*) {
    const bool is_news = known.atlas == nullptr || known.atlas->FindKeyframe(id) != nullptr || !known.atlas->Knows(id);
    if ((is_news && id.session == session) || std::ranges::binary_search(held, id)) gone.push_back(id);
  });
  return gone;
}

}  // namespace pangaea
