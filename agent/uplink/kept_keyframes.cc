#include "agent/uplink/kept_keyframes.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "common/base/median.h"
#include "common/map/covisibility.h"
#include "common/map/forgetting.h"

namespace pangaea {
namespace {

// Of the landmarks that the keyframe observes; 1 where it observes none.
double MedianDepth(const Atlas& atlas, const Keyframe& keyframe) {
  std::vector<double> depths;
  for (const LandmarkId id : keyframe.landmarks) {
    if (id.valid()) depths.push_back((keyframe.camera_from_map * atlas.FindLandmark(id)->point_in_map).z());
  }
  return Median(std::move(depths), 1.0);
}

bool HasFrames(const Keyframe& keyframe, const Keyframe& confirmed) {
  const std::size_t here = keyframe.frames ? keyframe.frames->size() : 0;
  return here <= (confirmed.frames ? confirmed.frames->size() : 0);
}

// What it alone sees is not sent before the end (UplinkPlannerOptions::min_observations), and nothing that would be
// missed here.
bool HasLandmarks(const Atlas& atlas, const Keyframe& keyframe, const Keyframe& confirmed) {
  if (confirmed.landmarks.size() != keyframe.landmarks.size()) return false;
  for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    const LandmarkId here = keyframe.landmarks[i];
    if (here == confirmed.landmarks[i]) continue;
    const bool waits =
        here.valid() && !confirmed.landmarks[i].valid() && atlas.FindLandmark(here)->observations.size() == 1;
    if (!waits) return false;
  }
  return true;
}

bool HasJustAsWell(const Atlas& atlas, const Atlas& confirmed, const Keyframe& keyframe) {
  const Keyframe* there = confirmed.FindKeyframe(keyframe.id);
  return there != nullptr && HasLandmarks(atlas, keyframe, *there) && HasFrames(keyframe, *there);
}

bool IsForgottenIn(const Atlas& atlas, KeyframeId id) {
  const Keyframe* keyframe = atlas.FindKeyframe(id);
  return keyframe != nullptr && IsForgotten(*keyframe);
}

// The newest keyframe may not have been sent: the nearest one that the server knows says as well where the camera is.
KeyframeId NearestKnown(const std::vector<KeyframeId>& nearest, const Atlas& confirmed, SessionId session,
                        KeyframeId otherwise) {
  const auto known = std::ranges::find_if(nearest, [&](KeyframeId id) {
    return id.session == session && confirmed.FindKeyframe(id) != nullptr && !IsForgottenIn(confirmed, id);
  });
  return known == nearest.end() ? otherwise : *known;
}

}  // namespace

KeptKeyframesOptions KeptKeyframesOptions::Of(std::size_t most, std::size_t left) {
  return {most, left, left * 3 / 5, static_cast<std::uint32_t>(left / 5), left / 2};
}

Status KeptKeyframesOptions::Check() const {
  if (most == 0 || (recalled < left && window < left && newest < left && left <= most)) return {};
  return Fail(ErrorCode::kInvalidArgument, "memory: kept_keyframes is " + std::to_string(left) +
                                               "; allowed: more than " +
                                               std::to_string(std::max({recalled, window, std::size_t{newest}})) +
                                               ", at most max_keyframes (" + std::to_string(most) + ")");
}

std::vector<KeyframeId> NearestKeyframes(const Atlas& atlas, const Keyframe& center) {
  const Eigen::Vector3d ahead(0.0, 0.0, MedianDepth(atlas, center));
  const Rigid3d map_from_center = center.camera_from_map.Inverse();
  std::vector<std::pair<double, KeyframeId>> ranked;
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    double distance = std::numeric_limits<double>::infinity();
    if (keyframe.map == center.map) {
      const Rigid3d map_from_camera = keyframe.camera_from_map.Inverse();
      distance = (map_from_camera.translation() - map_from_center.translation()).norm() +
                 (map_from_camera * ahead - map_from_center * ahead).norm();
    }
    ranked.emplace_back(distance, keyframe.id);
  });
  std::sort(ranked.begin(), ranked.end());
  std::vector<KeyframeId> nearest;
  for (const auto& [distance, id] : ranked) nearest.push_back(id);
  return nearest;
}

std::vector<KeyframeId> ChooseForgotten(const Atlas& atlas, const Atlas& confirmed, KeyframeId center,
                                        SessionId session, const KeptKeyframesOptions& options) {
  const Keyframe* near = atlas.FindKeyframe(atlas.Resolve(center));
  if (options.most == 0 || near == nullptr) return {};
  std::size_t held = 0;
  std::uint32_t newest = 0;
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    held += IsForgotten(keyframe) ? 0 : 1;
    if (keyframe.id.session == session) newest = std::max(newest, keyframe.id.counter);
  });
  if (held <= options.most) return {};
  const std::vector<KeyframeId> window = GrowWindow(atlas, near->id, options.window);
  const std::set<KeyframeId> in_use(window.begin(), window.end());
  std::vector<KeyframeId> farthest = NearestKeyframes(atlas, *near);
  std::ranges::reverse(farthest);
  std::vector<KeyframeId> forgotten;
  for (const KeyframeId id : farthest) {
    if (held <= options.left) break;
    const Keyframe& keyframe = *atlas.FindKeyframe(id);
    if (IsForgotten(keyframe) || in_use.contains(id)) continue;
    const bool is_new = id.session == session && id.counter + options.newest > newest;
    if (is_new || !HasJustAsWell(atlas, confirmed, keyframe)) continue;
    forgotten.push_back(id);
    --held;
  }
  return forgotten;
}

MapInterest InterestOf(SessionId session, const Atlas& atlas, const Atlas& confirmed, KeyframeId center,
                       const KeptKeyframesOptions& options) {
  MapInterest interest;
  interest.session = session;
  interest.reference = atlas.Resolve(center);
  const auto is_forgotten = [&](KeyframeId id) { return IsForgottenIn(atlas, id) && IsForgottenIn(confirmed, id); };
  bool all = true;
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    const bool forgotten = is_forgotten(keyframe.id);
    const bool own = keyframe.id.session == session;
    all = all && !(own && forgotten);
    if (!forgotten) (own ? interest.held : interest.guests).push_back(keyframe.id);
  });
  if (all) interest.held.clear();
  const Keyframe* near = atlas.FindKeyframe(interest.reference);
  if (near == nullptr) return interest;
  interest.map = near->map;
  const std::vector<KeyframeId> nearest = NearestKeyframes(atlas, *near);
  interest.reference = NearestKnown(nearest, confirmed, session, near->id);
  for (std::size_t rank = 0; rank < std::min(options.recalled, nearest.size()); ++rank) {
    const bool here = atlas.FindKeyframe(nearest[rank])->map == near->map;
    if (here && is_forgotten(nearest[rank])) interest.wanted.push_back(nearest[rank]);
  }
  return interest;
}

}  // namespace pangaea
