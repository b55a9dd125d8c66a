// How Tracker begins a monocular map: not with one frame, but with two and the motion between them.
#include <utility>

#include "agent/tracking/tracker.h"

namespace pangaea {

bool Tracker::StartMonocularMap(std::int64_t stamp_ns, const cv::Mat& left, TrackingResult& result,
                                StageRecorder& stages) {
  StageScope scope(stages, "tracking.start");
  std::optional<MonocularOpening> opening;
  if (!monocular_start_.wants_first_frame()) opening = monocular_start_.Follow(stamp_ns, current_image_);
  if (!opening) {
    if (monocular_start_.wants_first_frame()) {
      monocular_start_.Begin(stamp_ns, current_image_, builder_.Extract(left));
    }
    return false;
  }
  BeginMap();
  Adopt(*opening, builder_.Describe(stamp_ns, left, {}, opening->second_points, {}, stages), result);
  return true;
}

void Tracker::Adopt(const MonocularOpening& opening, std::shared_ptr<const KeyframeData> second,
                    TrackingResult& result) {
  auto first = std::make_shared<KeyframeData>();
  first->stamp_ns = opening.first_stamp_ns;
  first->camera = camera_;
  first->features = opening.first_features;
  const KeyframeId second_id{session_, ++keyframes_made_};
  newest_keyframe_ns_ = second->stamp_ns;
  const Rigid3d& second_from_first = opening.second_from_first;
  recent_keyframes_.Add(first_keyframe_, opening.first_image, KeyframeId{}, Rigid3d(), {});
  recent_keyframes_.Add(second_id, current_image_, first_keyframe_, second_from_first, {});
  previous_ = LatestFrame{second_id, Rigid3d(), 1.0, second->stamp_ns, Vector6d::Zero(), {}};
  for (const OpeningPoint& point : opening.points) {
    previous_->points_in_camera.push_back(second_from_first * point.point_in_first);
  }
  result.state = TrackingState::kTracking;
  result.tracked = true;
  result.map = map_;
  result.reference = second_id;
  result.pose = FramePose{second->stamp_ns, Rigid3d()};
  result.camera_from_map = second_from_first;
  result.inliers = static_cast<int>(opening.points.size());
  result.earlier_frames.push_back({first_keyframe_, FramePose{opening.first_stamp_ns, Rigid3d()}});
  for (const FramePose& frame : opening.between) result.earlier_frames.push_back({first_keyframe_, frame});
  result.opening = std::make_shared<const MapOpening>(
      MapOpening{.first = {first_keyframe_, map_, std::move(first), {}, Rigid3d(), {}},
                 .second = {second_id, map_, std::move(second), first_keyframe_, second_from_first, {}},
                 .points = opening.points});
}

}  // namespace pangaea
