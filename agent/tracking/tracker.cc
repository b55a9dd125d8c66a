#include "agent/tracking/tracker.h"

#include <algorithm>
#include <map>
#include <utility>

#include "agent/tracking/resolved_pose.h"
#include "common/base/check.h"

namespace pangaea {
namespace {

// Points in the camera frame of all keypoints with a depth up to `max_depth`.
std::vector<Eigen::Vector3d> StereoPoints(const KeyframeData& data, double max_depth) {
  std::vector<Eigen::Vector3d> points;
  for (const Keypoint& keypoint : data.features.keypoints) {
    if (!keypoint.has_depth()) continue;
    const double depth = data.camera.focal_x * data.camera.baseline / (keypoint.u - keypoint.u_right);
    if (depth <= max_depth) points.push_back(data.camera.Unproject({keypoint.u, keypoint.v}) * depth);
  }
  return points;
}

// The session's keyframe that observes most of the tracked landmarks; `current` unless another is clearly ahead. Frames
// hang below keyframes of their own session, so another session's is one only while there is none.
KeyframeId BestReference(const Atlas& atlas, const LocatedFrame& located, const LocalMap& local_map, KeyframeId current,
                         SessionId session) {
  constexpr double kClearlyAhead = 1.1;
  std::map<KeyframeId, int> shared;
  for (const LandmarkMatch& match : located.matches) {
    const Landmark* landmark = atlas.FindLandmark(local_map.landmarks[static_cast<std::size_t>(match.landmark)].id);
    if (landmark == nullptr) continue;
    for (const Observation& observation : landmark->observations) {
      if (observation.keyframe.session == session) ++shared[observation.keyframe];
    }
  }
  KeyframeId best = current;
  double best_count = kClearlyAhead * (shared.contains(current) ? shared[current] : 0);
  for (const auto& [keyframe, count] : shared) {
    if (count <= best_count) continue;
    best = keyframe;
    best_count = count;
  }
  return best;
}

}  // namespace

Tracker::Tracker(SessionId session, const IdealCamera& camera, const TrackingOptions& options,
                 std::shared_ptr<const VocabularyTree> vocabulary, std::uint64_t seed)
    : session_(session),
      camera_(camera),
      options_(options.ForCamera(camera)),
      builder_(camera, options_.orb, options.stereo),
      decision_(options_.keyframes),
      monocular_start_(camera, options.monocular_start,
                       {options.search.alignment, options.sparse_alignment, options.search.patch_sigma}, seed),
      templates_(options.max_templates),
      recognition_(camera, options.recognition, std::move(vocabulary), seed),
      recent_keyframes_(options.template_images) {}

TrackingResult Tracker::Track(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right,
                              const std::shared_ptr<const Atlas>& atlas, StageRecorder& stages) {
  StageScope scope(stages, "tracking");
  TrackingResult result;
  {
    StageScope pyramid_scope(stages, "tracking.pyramid");
    BuildImagePyramid(left, options_.pyramid_levels, current_image_);
  }
  {
    StageScope snapshot_scope(stages, "tracking.snapshot");
    AdoptSnapshot(atlas);
  }
  closing_.reset();
  if (!map_.valid()) {
    StartMap(stamp_ns, left, right, result, stages);
  } else if (!awaits_first_keyframe(*atlas_)) {
    TrackKnownMap(stamp_ns, left, right, result, stages);
  }
  if (result.tracked) monocular_start_.Reset();
  // The next frame is predicted from the latest tracked one.
  if (result.tracked) std::swap(previous_image_, current_image_);
  return result;
}

bool Tracker::awaits_first_keyframe(const Atlas& atlas) const { return map_.valid() && !atlas.Knows(first_keyframe_); }

void Tracker::AdoptSnapshot(const std::shared_ptr<const Atlas>& atlas) {
  PANGAEA_CHECK(atlas != nullptr);
  recognition_.Follow(*atlas);  // every time: it learns a few keyframes at once
  if (atlas_ == atlas) return;
  const bool was_under_way = atlas_ != nullptr && MappingIsBusy();
  atlas_ = atlas;
  if (map_.valid() && !awaits_first_keyframe(*atlas_)) map_ = atlas_->Resolve(map_);  // maps may have been joined
  if (previous_) previous_->FollowScale(*atlas_);
  if (!map_.valid() || awaits_first_keyframe(*atlas_)) return;
  recent_keyframes_.Harvest(*atlas_, options_.new_view_angle, templates_);
  // A keyframe that has come into the map saw all that was tracked at it, and what was created there since. Where the
  // camera has another reference by now it is not as near to it any more.
  const KeyframeId arrived = was_under_way ? recent_keyframes_.NewestTrackedAgainst(reference_, *atlas_) : KeyframeId{};
  const KeyframeId living = arrived.valid() ? arrived : atlas_->Resolve(reference_);
  RebuildLocalMap(living.valid() ? living : first_keyframe_);
}

void Tracker::RebuildLocalMap(KeyframeId reference) {
  reference_ = reference;
  local_map_ = CollectLocalMap(*atlas_, reference, templates_, local_map_, options_.local_map);
}

std::optional<Rigid3d> Tracker::PreviousPose() const { return previous_ ? previous_->PoseIn(*atlas_) : std::nullopt; }

void Tracker::TrackKnownMap(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right, TrackingResult& result,
                            StageRecorder& stages) {
  std::optional<LocatedFrame> located = LocateByMotion(stamp_ns, stages);
  if (!located) {
    located = LocateAnywhere(stamp_ns, left, stages);
  } else if (located->pose.inliers < options_.weak_inliers) {
    located = LocateAgain(left, std::move(*located), stages);
  }
  if (!located) return Lose(stamp_ns, left, right, result, stages);
  FinishTracked(stamp_ns, *located, result);
  ConsiderKeyframe(stamp_ns, left, right, *located, result, stages);
  if (!result.keyframe) HangBelowKeyframeUnderWay(result);
  if (closing_) PlaceAsTracked(result, *closing_);
}

bool Tracker::IsTrusted(const LocatedFrame& located, const LocalMap& local_map, int min_inliers) const {
  return located.pose.inliers >= min_inliers && located.pose.inliers >= options_.min_agreement * located.found &&
         PositionIsObservable(located, local_map, camera_.is_stereo(), options_.observability);
}

std::optional<LocatedFrame> Tracker::LocateByMotion(std::int64_t stamp_ns, StageRecorder& stages) {
  const auto previous_pose = PreviousPose();
  if (!previous_pose || frames_lost_ > options_.frames_predicted) return std::nullopt;
  Rigid3d current_from_previous = previous_->MotionUntil(stamp_ns);
  {
    StageScope scope(stages, "tracking.prediction");
    const auto aligned = AlignSparsely(previous_image_, current_image_, camera_, previous_->points_in_camera,
                                       current_from_previous, options_.sparse_alignment);
    if (aligned) current_from_previous = *aligned;
  }
  StageScope scope(stages, "tracking.local_map");
  auto located =
      LocateFrame(current_image_, camera_, current_from_previous * *previous_pose, local_map_, options_.search);
  if (located && located->pose.inliers < options_.weak_inliers) {
    // From a poor prediction the first search finds little; from its result the second finds the rest.
    auto again = LocateFrame(current_image_, camera_, located->pose.camera_from_map, local_map_, options_.search);
    if (again && again->pose.inliers > located->pose.inliers) located = std::move(again);
  }
  if (!located || !IsTrusted(*located, local_map_, options_.min_inliers)) return std::nullopt;
  return located;
}

void Tracker::FinishTracked(std::int64_t stamp_ns, const LocatedFrame& located, TrackingResult& result) {
  const Rigid3d& camera_from_map = located.pose.camera_from_map;
  const KeyframeId reference = BestReference(*atlas_, located, local_map_, reference_, session_);
  const Rigid3d& reference_from_map = atlas_->FindKeyframe(reference)->camera_from_map;
  LatestFrame previous;
  previous.reference = reference;
  previous.reference_from_frame = reference_from_map * camera_from_map.Inverse();
  previous.scale = atlas_->FindKeyframe(reference)->scale;
  previous.stamp_ns = stamp_ns;
  previous.velocity = VelocityInto(stamp_ns, camera_from_map);
  for (const LandmarkMatch& match : located.matches) {
    previous.points_in_camera.push_back(camera_from_map *
                                        local_map_.landmarks[static_cast<std::size_t>(match.landmark)].point_in_map);
  }
  if (previous_ && stamp_ns > previous_->stamp_ns) {
    const auto previous_pose = PreviousPose();
    const bool known = previous_pose && IsInMap(*atlas_, previous_->reference, map_);
    result.current_from_previous = known ? std::optional(camera_from_map * previous_pose->Inverse()) : std::nullopt;
  }
  result.state = TrackingState::kTracking;
  result.tracked = true;
  result.map = map_;
  result.reference = reference;
  result.reference_scale = {previous.scale};
  result.map_scale = previous.scale;
  result.pose = FramePose{stamp_ns, previous.reference_from_frame};
  result.camera_from_map = camera_from_map;
  result.inliers = located.pose.inliers;
  HangBelowOwnKeyframe(result);
  previous_ = std::move(previous);
  frames_lost_ = 0;
  frames_searched_ = 0;
  hint_.reset();
}

// Of the camera; zero where the motion is not known, as after a loss.
Vector6d Tracker::VelocityInto(std::int64_t stamp_ns, const Rigid3d& camera_from_map) const {
  if (!previous_ || frames_lost_ > 0) return Vector6d::Zero();
  return previous_->VelocityInto(stamp_ns, camera_from_map, map_, *atlas_);
}

void Tracker::ConsiderKeyframe(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right,
                               const LocatedFrame& located, TrackingResult& result, StageRecorder& stages) {
  const KeyframeEvidence evidence = GatherEvidence(camera_, located, local_map_, options_.keyframes);
  const Rigid3d& camera_from_map = located.pose.camera_from_map;
  const bool due = decision_.IsDue(evidence, NearestView(camera_from_map, evidence.median_depth), MappingIsBusy());
  // In a map of others the session needs a keyframe of its own for its frames.
  const bool wanted = lacks_templates_ || result.reference.session != session_;
  if (due || (wanted && !MappingIsBusy())) {
    KeepFrame(stamp_ns, left, right, located, result, stages);
  } else if (decision_.is_gap_over()) {
    closing_.emplace(RawOf(stamp_ns, left, right, located));
  }
  if (previous_->reference != reference_) RebuildLocalMap(previous_->reference);
}

void Tracker::KeepFrame(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right,
                        const LocatedFrame& located, TrackingResult& result, StageRecorder& stages) {
  StageScope scope(stages, "tracking.keyframe");
  RawKeyframe keyframe = RawOf(stamp_ns, left, right, located);
  EnterLargerMap(stamp_ns, left, keyframe, result, stages);
  PlaceAsTracked(result, keyframe);
  Number(keyframe);
  recent_keyframes_.Add(keyframe.id, current_image_, keyframe.reference, keyframe.camera_from_reference,
                        keyframe.reference_scale);
  // The keyframe is this frame: bundle adjustment moves both.
  result.reference = keyframe.id;
  result.pose.reference_from_frame = Rigid3d();
  result.reference_scale = {};
  result.keyframe = std::move(keyframe);
  decision_.Restart();
  lacks_templates_ = false;
}

// Without number and place.
RawKeyframe Tracker::RawOf(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right,
                           const LocatedFrame& located) const {
  RawKeyframe keyframe;
  keyframe.stamp_ns = stamp_ns;
  keyframe.left = left;
  keyframe.right = right;
  TakeTracked(located, local_map_, keyframe);
  return keyframe;
}

void Tracker::PlaceAsTracked(const TrackingResult& result, RawKeyframe& keyframe) const {
  keyframe.map = map_;
  keyframe.reference = result.reference;
  keyframe.camera_from_reference = result.pose.reference_from_frame.Inverse();
  keyframe.reference_scale = result.reference_scale;
}

void Tracker::Number(RawKeyframe& keyframe) {
  keyframe.id = KeyframeId{session_, ++keyframes_made_};
  keyframe.arrival = {keyframe.reference, keyframe.camera_from_reference, keyframe.reference_scale.value,
                      std::exchange(newest_keyframe_ns_, keyframe.stamp_ns)};
}

std::optional<RawKeyframe> Tracker::TakeClosingKeyframe() {
  std::optional<RawKeyframe> closing = std::exchange(closing_, std::nullopt);
  if (closing) Number(*closing);
  return closing;
}

double Tracker::NearestView(const Rigid3d& camera_from_map, double median_depth) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const KeyframeId id : local_map_.keyframes) {
    const Rigid3d& keyframe_from_map = atlas_->FindKeyframe(id)->camera_from_map;
    const double distance = ViewDistance(camera_from_map, keyframe_from_map, median_depth, options_.keyframes);
    nearest = std::min(nearest, id.session == session_ ? distance : options_.keyframes.others_view * distance);
  }
  for (const Rigid3d& recent_from_map : recent_keyframes_.PosesUnderWay(*atlas_)) {
    nearest = std::min(nearest, ViewDistance(camera_from_map, recent_from_map, median_depth, options_.keyframes));
  }
  return nearest;
}

bool Tracker::StartMap(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right, TrackingResult& result,
                       StageRecorder& stages) {
  if (!camera_.is_stereo()) return StartMonocularMap(stamp_ns, left, result, stages);
  auto data = builder_.Describe(stamp_ns, left, right, {}, {}, stages);
  const std::vector<Eigen::Vector3d> points = StereoPoints(*data, options_.start_depth_baselines * camera_.baseline);
  if (std::cmp_less(points.size(), options_.min_start_points)) return false;
  BeginMap();
  newest_keyframe_ns_ = stamp_ns;
  recent_keyframes_.Add(first_keyframe_, current_image_, KeyframeId{}, Rigid3d(), {});
  previous_ = LatestFrame{first_keyframe_, Rigid3d(), 1.0, stamp_ns, Vector6d::Zero(), points};
  result.state = TrackingState::kTracking;
  result.tracked = true;
  result.map = map_;
  result.reference = first_keyframe_;
  result.pose = FramePose{stamp_ns, Rigid3d()};
  result.camera_from_map = Rigid3d();
  result.inliers = static_cast<int>(points.size());
  std::vector<LandmarkId> none(data->features.keypoints.size());
  result.root = KeyframeCandidate{first_keyframe_, map_, std::move(data), {}, Rigid3d(), std::move(none)};
  return true;
}

// What a new map has in common with any other new map.
void Tracker::BeginMap() {
  map_ = MapId{session_, ++maps_made_};
  first_keyframe_ = KeyframeId{session_, ++keyframes_made_};
  reference_ = first_keyframe_;
  local_map_ = LocalMap{};
  recent_keyframes_.Clear();
  decision_.Restart();
  frames_lost_ = 0;
  frames_searched_ = 0;
  hint_.reset();
  lacks_templates_ = false;
}

bool Tracker::MappingIsBusy() const { return recent_keyframes_.IsOneUnderWay(*atlas_); }

}  // namespace pangaea
