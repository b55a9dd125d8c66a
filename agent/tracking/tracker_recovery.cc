// What the tracker does when the camera is lost, and where it goes on then.
#include <utility>

#include "agent/tracking/resolved_pose.h"
#include "agent/tracking/tracker.h"
#include "common/map/covisibility.h"

namespace pangaea {

void Tracker::Lose(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right, TrackingResult& result,
                   StageRecorder& stages) {
  result.state = TrackingState::kLost;
  result.unrecognised = std::exchange(unrecognised_, nullptr);
  ++frames_lost_;
  const int patience = options_.frames_until_new_map + (hint_ ? options_.frames_for_hint : 0);
  if (frames_searched_ >= patience) StartMap(stamp_ns, left, right, result, stages);
}

void Tracker::Suggest(const PlaceHint& hint) {
  if (frames_lost_ > 0) hint_ = hint;
}

// In all maps.
std::optional<LocatedFrame> Tracker::LocateAnywhere(std::int64_t stamp_ns, const cv::Mat& left, StageRecorder& stages) {
  StageScope scope(stages, "tracking.relocalization");
  Features features = builder_.Extract(left);
  if (std::cmp_less(features.keypoints.size(), options_.min_start_points)) return std::nullopt;
  ++frames_searched_;
  auto recognised = RecogniseAnywhere(features);
  if (recognised) return Enter(std::move(*recognised));
  unrecognised_ = std::make_shared<const KeyframeData>(KeyframeData{stamp_ns, camera_, std::move(features)});
  return std::nullopt;
}

// First where somebody else has found the camera: it has not gone far since.
std::optional<RecognisedFrame> Tracker::RecogniseAnywhere(const Features& features) const {
  std::vector<KeyframeId> nearby;
  const KeyframeId hinted = hint_ ? atlas_->Resolve(hint_->keyframe) : KeyframeId{};
  if (const auto hinted_from_map = hinted.valid() ? PoseOf(*atlas_, hint_->keyframe) : std::nullopt) {
    auto found = recognition_.LocateNear(features, *atlas_, hinted, hint_->camera_from_keyframe * *hinted_from_map,
                                         Surroundings(), Trust(options_.min_recovery_inliers));
    if (found) return found;
    nearby = GrowWindow(*atlas_, hinted, options_.recognition.local_candidates);
  }
  nearby.insert(nearby.end(), local_map_.keyframes.begin(), local_map_.keyframes.end());
  return recognition_.LocateWidely(features, *atlas_, recognition_.Candidates(features, nearby), Surroundings(),
                                   Trust(options_.min_recovery_inliers));
}

// A thin result may be a wrong one: what is recognised nearby without any prediction decides if it explains more.
LocatedFrame Tracker::LocateAgain(const cv::Mat& left, LocatedFrame thin, StageRecorder& stages) {
  StageScope scope(stages, "tracking.relocalization");
  auto recognised = Recognise(builder_.Extract(left), local_map_.keyframes, options_.min_recovery_inliers);
  if (!recognised || recognised->located.pose.inliers <= thin.pose.inliers) return thin;
  return Enter(std::move(*recognised));
}

Recognition::Surroundings Tracker::Surroundings() const {
  return [this](KeyframeId id) { return CollectLocalMap(*atlas_, id, templates_, local_map_, options_.local_map); };
}

Recognition::Trust Tracker::Trust(int min_inliers) const {
  return [this, min_inliers](const LocatedFrame& located, const LocalMap& local_map) {
    return IsTrusted(located, local_map, min_inliers);
  };
}

std::optional<RecognisedFrame> Tracker::Recognise(const Features& features, std::span<const KeyframeId> candidates,
                                                  int min_inliers) const {
  return recognition_.Locate(features, *atlas_, candidates, Surroundings(), Trust(min_inliers));
}

// Goes on where the frame was recognised. The better of both: what descriptors found there, or what templates find.
LocatedFrame Tracker::Enter(RecognisedFrame recognised) {
  map_ = recognised.map;
  first_keyframe_ = atlas_->FindMap(map_)->root;
  local_map_ = std::move(recognised.local_map);
  reference_ = local_map_.keyframes.front();
  LocatedFrame& by_descriptors = recognised.located;
  auto by_patches =
      LocateFrame(current_image_, camera_, by_descriptors.pose.camera_from_map, local_map_, options_.search);
  lacks_templates_ = !by_patches || by_patches->pose.inliers < by_descriptors.pose.inliers ||
                     !IsTrusted(*by_patches, local_map_, options_.min_inliers);
  return lacks_templates_ ? std::move(by_descriptors) : std::move(*by_patches);
}

// A small map is left for a larger one as soon as its place is recognised: after a loss the camera mostly comes back to
// where it was.
void Tracker::EnterLargerMap(std::int64_t stamp_ns, const cv::Mat& left, RawKeyframe& keyframe, TrackingResult& result,
                             StageRecorder& stages) {
  const std::uint32_t size = atlas_->FindMap(map_)->keyframes;
  const auto maps = atlas_->Maps();
  const auto is_larger = [&](MapId map) { return atlas_->FindMap(map)->keyframes > size; };
  if (std::none_of(maps.begin(), maps.end(), is_larger)) return;
  StageScope scope(stages, "tracking.relocalization");
  const Features features = builder_.Extract(left, keyframe.tracked);
  const auto admits = [&](KeyframeId id) { return is_larger(atlas_->FindKeyframe(id)->map); };
  auto recognised = Recognise(features, recognition_.Candidates(features, {}, admits), options_.weak_inliers);
  if (!recognised) return;
  const LocatedFrame by_descriptors = recognised->located;
  TakeTracked(by_descriptors, recognised->local_map, keyframe);
  Enter(std::move(*recognised));
  FinishTracked(stamp_ns, by_descriptors, result);
}

// In a map of others the session's first keyframe may still be on its way into the map, or see nothing that this frame
// sees. Frames hang below it all the same: they are the session's.
void Tracker::HangBelowOwnKeyframe(TrackingResult& result) const {
  if (result.reference.session == session_) return;
  const auto own = recent_keyframes_.NewestIn(map_, session_, *atlas_);
  if (own) HangBelow(*own, result);
}

// A frame after a keyframe that is not in the map yet was tracked in the same map as that one, and is off as it is:
// what the map makes of the keyframe holds for the frame, too.
void Tracker::HangBelowKeyframeUnderWay(TrackingResult& result) const {
  if (!MappingIsBusy()) return;
  const auto newest = recent_keyframes_.NewestIn(map_, session_, *atlas_);
  if (newest && !newest->scale) HangBelow(*newest, result);
}

// Of one under way, lengths are still those of the reference that the frame was measured against.
void Tracker::HangBelow(const RecentKeyframes::Place& keyframe, TrackingResult& result) {
  result.reference = keyframe.id;
  result.pose.reference_from_frame = keyframe.camera_from_map * result.camera_from_map.Inverse();
  if (keyframe.scale) result.reference_scale = *keyframe.scale;
}

}  // namespace pangaea
