#include "agent/tracking/tracker.h"

#include <algorithm>
#include <map>
#include <utility>

#include "agent/tracking/template_harvest.h"
#include "common/base/check.h"

namespace pangaea {
namespace {

ImagePyramid Copy(const ImagePyramid& image) {
  ImagePyramid copy;
  copy.levels.push_back(image.levels.front());  // the image itself never changes
  for (std::size_t level = 1; level < image.levels.size(); ++level) copy.levels.push_back(image.levels[level].clone());
  return copy;
}

double Seconds(std::int64_t nanoseconds) { return 1e-9 * static_cast<double>(nanoseconds); }

std::optional<Rigid3d> PoseOf(const Atlas& atlas, KeyframeId id) {
  const auto resolved = atlas.ResolvePose(id);
  if (!resolved) return std::nullopt;
  return resolved->keyframe_from_asked.Inverse() * resolved->keyframe->camera_from_map;
}

// Points in the camera frame of all keypoints with depth.
std::vector<Eigen::Vector3d> StereoPoints(const KeyframeData& data) {
  std::vector<Eigen::Vector3d> points;
  for (const Keypoint& keypoint : data.features.keypoints) {
    if (!keypoint.has_depth()) continue;
    const double depth = data.camera.focal_x * data.camera.baseline / (keypoint.u - keypoint.u_right);
    points.push_back(data.camera.Unproject({keypoint.u, keypoint.v}) * depth);
  }
  return points;
}

// The keyframe that observes most of the tracked landmarks; `current` unless another is clearly ahead.
KeyframeId BestReference(const Atlas& atlas, const LocatedFrame& located, const LocalMap& local_map,
                         KeyframeId current) {
  constexpr double kClearlyAhead = 1.1;
  std::map<KeyframeId, int> shared;
  for (const LandmarkMatch& match : located.matches) {
    const Landmark* landmark = atlas.FindLandmark(local_map.landmarks[static_cast<std::size_t>(match.landmark)].id);
    if (landmark == nullptr) continue;
    for (const Observation& observation : landmark->observations) ++shared[observation.keyframe];
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

Tracker::Tracker(SessionId session, const IdealCamera& camera, const TrackingOptions& options, std::uint64_t seed)
    : session_(session),
      camera_(camera),
      options_(options),
      seed_(seed),
      builder_(camera, options.orb, options.stereo),
      decision_(options.keyframes),
      templates_(options.max_templates) {}

TrackingResult Tracker::Track(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right,
                              const std::shared_ptr<const Atlas>& atlas, StageRecorder& stages) {
  StageScope scope(stages, "tracking");
  TrackingResult result;
  {
    StageScope pyramid_scope(stages, "tracking.pyramid");
    BuildImagePyramid(left, options_.pyramid_levels, current_image_);
  }
  AdoptSnapshot(atlas);
  if (!map_.valid()) {
    StartMap(stamp_ns, left, right, result, stages);
  } else if (!awaits_first_keyframe(*atlas_)) {
    TrackKnownMap(stamp_ns, left, right, result, stages);
  }
  // The next frame is predicted from the latest tracked one.
  if (result.tracked) std::swap(previous_image_, current_image_);
  return result;
}

bool Tracker::awaits_first_keyframe(const Atlas& atlas) const { return map_.valid() && !atlas.Knows(first_keyframe_); }

void Tracker::AdoptSnapshot(const std::shared_ptr<const Atlas>& atlas) {
  PANGAEA_CHECK(atlas != nullptr);
  if (atlas_ == atlas) return;
  atlas_ = atlas;
  if (!map_.valid() || awaits_first_keyframe(*atlas_)) return;
  for (RecentKeyframe& keyframe : recent_keyframes_) {
    HarvestTemplates(*atlas_, keyframe.id, keyframe.image, options_.new_view_angle, templates_);
  }
  const KeyframeId living = atlas_->Resolve(reference_);
  RebuildLocalMap(living.valid() ? living : first_keyframe_);
}

void Tracker::RebuildLocalMap(KeyframeId reference) {
  reference_ = reference;
  local_map_ = CollectLocalMap(*atlas_, reference, templates_, local_map_, options_.local_map);
}

std::optional<Rigid3d> Tracker::PreviousPose() const {
  if (!previous_) return std::nullopt;
  const auto reference_from_map = PoseOf(*atlas_, previous_->reference);
  if (!reference_from_map) return std::nullopt;
  return previous_->reference_from_frame.Inverse() * *reference_from_map;
}

void Tracker::TrackKnownMap(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right, TrackingResult& result,
                            StageRecorder& stages) {
  std::optional<LocatedFrame> located = LocateByMotion(stamp_ns, stages);
  if (!located || located->pose.inliers < options_.weak_inliers) {
    // A thin result may be a wrong one: what is recognised without any prediction decides if it explains more.
    auto recognised = LocateByRecognition(left, stages);
    if (recognised && (!located || recognised->frame.pose.inliers > located->pose.inliers)) {
      located = std::move(recognised->frame);
      local_map_ = std::move(recognised->local_map);
      reference_ = local_map_.keyframes.front();
    }
  }
  if (located) {
    FinishTracked(stamp_ns, *located, result);
    ConsiderKeyframe(stamp_ns, left, right, *located, result, stages);
    return;
  }
  result.state = TrackingState::kLost;
  ++frames_lost_;
  if (frames_lost_ >= options_.frames_until_new_map) StartMap(stamp_ns, left, right, result, stages);
}

bool Tracker::IsTrusted(const LocatedFrame& located, int min_inliers) const {
  return located.pose.inliers >= min_inliers && located.pose.inliers >= options_.min_agreement * located.found;
}

std::optional<LocatedFrame> Tracker::LocateByMotion(std::int64_t stamp_ns, StageRecorder& stages) {
  const auto previous_pose = PreviousPose();
  if (!previous_pose || frames_lost_ > options_.frames_predicted) return std::nullopt;
  Rigid3d current_from_previous = Rigid3d::Exp(previous_->velocity * Seconds(stamp_ns - previous_->stamp_ns));
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
  if (!located || !IsTrusted(*located, options_.min_inliers)) return std::nullopt;
  return located;
}

std::optional<Tracker::RecognisedFrame> Tracker::LocateByRecognition(const cv::Mat& left, StageRecorder& stages) {
  StageScope scope(stages, "tracking.relocalization");
  const Features features = builder_.Extract(left);
  const auto recognised = Relocalize(camera_, features, *atlas_, local_map_.keyframes, options_.relocalization, seed_);
  if (!recognised) return std::nullopt;
  RecognisedFrame result;
  result.local_map = CollectLocalMap(*atlas_, recognised->keyframe, templates_, local_map_, options_.local_map);
  auto located = LocateFrame(current_image_, camera_, recognised->camera_from_map, result.local_map, options_.search);
  if (!located || !IsTrusted(*located, options_.min_recovery_inliers)) return std::nullopt;
  result.frame = std::move(*located);
  return result;
}

void Tracker::FinishTracked(std::int64_t stamp_ns, const LocatedFrame& located, TrackingResult& result) {
  const Rigid3d& camera_from_map = located.pose.camera_from_map;
  const KeyframeId reference = BestReference(*atlas_, located, local_map_, reference_);
  const Rigid3d& reference_from_map = atlas_->FindKeyframe(reference)->camera_from_map;
  const auto previous_pose = PreviousPose();
  Previous previous;
  previous.reference = reference;
  previous.reference_from_frame = reference_from_map * camera_from_map.Inverse();
  previous.stamp_ns = stamp_ns;
  // After a loss the motion is not known.
  if (previous_pose && frames_lost_ == 0 && stamp_ns > previous_->stamp_ns) {
    previous.velocity = (camera_from_map * previous_pose->Inverse()).Log() / Seconds(stamp_ns - previous_->stamp_ns);
  }
  for (const LandmarkMatch& match : located.matches) {
    previous.points_in_camera.push_back(camera_from_map *
                                        local_map_.landmarks[static_cast<std::size_t>(match.landmark)].point_in_map);
  }
  result.state = TrackingState::kTracking;
  result.tracked = true;
  result.map = map_;
  result.reference = reference;
  result.pose = FramePose{stamp_ns, previous.reference_from_frame};
  result.camera_from_map = camera_from_map;
  result.inliers = located.pose.inliers;
  previous_ = std::move(previous);
  frames_lost_ = 0;
}

void Tracker::ConsiderKeyframe(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right,
                               const LocatedFrame& located, TrackingResult& result, StageRecorder& stages) {
  const KeyframeEvidence evidence = GatherEvidence(camera_, located, local_map_, options_.keyframes);
  const Rigid3d& camera_from_map = located.pose.camera_from_map;
  if (decision_.IsDue(evidence, NearestView(camera_from_map, evidence.median_depth), MappingIsBusy())) {
    StageScope scope(stages, "tracking.keyframe");
    BuiltKeyframe built = builder_.Build(stamp_ns, left, right, &located, local_map_, stages);
    KeyframeCandidate candidate;
    candidate.id = KeyframeId{session_, ++keyframes_made_};
    candidate.map = map_;
    candidate.data = std::move(built.data);
    candidate.reference = result.reference;
    candidate.camera_from_reference = result.pose.reference_from_frame.Inverse();
    candidate.landmarks = std::move(built.landmarks);
    RememberKeyframe(candidate.id, candidate.reference, candidate.camera_from_reference);
    // The keyframe is this frame: bundle adjustment moves both.
    result.reference = candidate.id;
    result.pose.reference_from_frame = Rigid3d();
    result.keyframe = std::move(candidate);
    decision_.Restart();
  }
  if (previous_->reference != reference_) RebuildLocalMap(previous_->reference);
}

double Tracker::NearestView(const Rigid3d& camera_from_map, double median_depth) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const KeyframeId id : local_map_.keyframes) {
    const Rigid3d& keyframe_from_map = atlas_->FindKeyframe(id)->camera_from_map;
    nearest = std::min(nearest, ViewDistance(camera_from_map, keyframe_from_map, median_depth, options_.keyframes));
  }
  for (const RecentKeyframe& recent : recent_keyframes_) {
    const auto reference_from_map = PoseOf(*atlas_, recent.reference);
    if (!reference_from_map || atlas_->Knows(recent.id)) continue;
    nearest = std::min(nearest, ViewDistance(camera_from_map, recent.camera_from_reference * *reference_from_map,
                                             median_depth, options_.keyframes));
  }
  return nearest;
}

bool Tracker::StartMap(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right, TrackingResult& result,
                       StageRecorder& stages) {
  BuiltKeyframe built = builder_.Build(stamp_ns, left, right, nullptr, local_map_, stages);
  if (built.keypoints_with_depth < options_.min_start_points) return false;
  if (map_.valid()) result.closed_map = map_;
  map_ = MapId{session_, ++maps_made_};
  first_keyframe_ = KeyframeId{session_, ++keyframes_made_};
  reference_ = first_keyframe_;
  templates_.Clear();
  local_map_ = LocalMap{};
  recent_keyframes_.clear();
  RememberKeyframe(first_keyframe_, KeyframeId{}, Rigid3d());
  decision_.Restart();
  frames_lost_ = 0;
  previous_ = Previous{first_keyframe_, Rigid3d(), stamp_ns, Vector6d::Zero(), StereoPoints(*built.data)};
  result.state = TrackingState::kTracking;
  result.tracked = true;
  result.map = map_;
  result.reference = first_keyframe_;
  result.pose = FramePose{stamp_ns, Rigid3d()};
  result.camera_from_map = Rigid3d();
  result.inliers = built.keypoints_with_depth;
  result.keyframe =
      KeyframeCandidate{first_keyframe_, map_, std::move(built.data), {}, Rigid3d(), std::move(built.landmarks)};
  return true;
}

void Tracker::RememberKeyframe(KeyframeId id, KeyframeId reference, const Rigid3d& camera_from_reference) {
  recent_keyframes_.push_back(RecentKeyframe{id, Copy(current_image_), reference, camera_from_reference});
  if (recent_keyframes_.size() > options_.template_images) recent_keyframes_.pop_front();
}

bool Tracker::MappingIsBusy() const {
  return !recent_keyframes_.empty() && !atlas_->Knows(recent_keyframes_.back().id);
}

}  // namespace pangaea
