#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "agent/mapping/keyframe_candidate.h"
#include "agent/mapping/map_opening.h"
#include "agent/tracking/keyframe_builder.h"
#include "agent/tracking/keyframe_decision.h"
#include "agent/tracking/latest_frame.h"
#include "agent/tracking/local_map.h"
#include "agent/tracking/monocular_start.h"
#include "agent/tracking/patch_search.h"
#include "agent/tracking/place_inquiry.h"
#include "agent/tracking/recent_keyframes.h"
#include "agent/tracking/recognition.h"
#include "agent/tracking/sparse_alignment.h"
#include "agent/tracking/template_store.h"
#include "agent/tracking/tracking_options.h"
#include "common/base/stage_recorder.h"
#include "common/map/atlas.h"
#include "common/map/edits/add_frame_poses.h"

namespace pangaea {

enum class TrackingState {
  kStarting,  // no map yet, or the new map's first keyframe is still being mapped
  kTracking,
  kLost,  // looking for a known place
};

struct TrackingResult {
  TrackingState state = TrackingState::kStarting;
  // The pose was refined on enough landmarks of a map; the members down to `inliers` hold only then.
  bool tracked = false;
  MapId map;
  KeyframeId reference;
  FramePose pose;                  // relative to `reference`
  ReferenceScale reference_scale;  // of `reference`, when `pose` was measured
  Rigid3d camera_from_map;         // as known now; later corrections move the reference
  double map_scale = 1.0;          // by which corrections have multiplied lengths here (Keyframe::scale), as known now
  // The camera's motion since the frame tracked before, both measured in the present snapshot; none where that frame is
  // of another map.
  std::optional<Rigid3d> current_from_previous;
  int inliers = 0;
  std::optional<RawKeyframe> keyframe;    // for local mapping
  std::optional<KeyframeCandidate> root;  // ... where this frame begins a map
  // A monocular map begins with two keyframes at once; `pose` is relative to the second one.
  std::shared_ptr<const MapOpening> opening;
  // Frames before this one that a monocular map's beginning gave a pose; ascending by stamp.
  std::vector<TrackedFrame> earlier_frames;
  // What the frame shows, where it was found in none of the agent's maps: somebody else may know the place.
  std::shared_ptr<const KeyframeData> unrecognised;
};

// Follows the camera from frame to frame in the agent's map. Between keyframes landmarks are tracked by aligning
// patches with their templates, in the left image alone; stereo depth only where a map begins, corners and
// descriptors also where the camera is lost, where few landmarks are left, and at keyframes of a map that is smaller
// than another: others get theirs on the way into the map. The result depends on the images and snapshots given alone.
// One owner thread.
class Tracker {
 public:
  // `options` have passed Check(). `vocabulary` is what known places are recognised by.
  Tracker(SessionId session, const IdealCamera& camera, const TrackingOptions& options,
          std::shared_ptr<const VocabularyTree> vocabulary, std::uint64_t seed);

  // One frame. `left` is rectified and must not change afterwards; `atlas` is the newest snapshot of local mapping.
  // Stage "tracking" and its parts.
  TrackingResult Track(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right,
                       const std::shared_ptr<const Atlas>& atlas, StageRecorder& stages);

  // After the last frame: this one as a keyframe, where it was tracked and neither it nor the one before is one. The
  // frames since the newest keyframe have no other to share what becomes of it
  // (docs/decisions/0029-frames-between-keyframes.md).
  std::optional<RawKeyframe> TakeClosingKeyframe();

  // While lost: where somebody who knows more than this agent's maps found one of the frames since. Of use as soon as
  // that keyframe is in the snapshots, and until the camera is known again.
  void Suggest(const PlaceHint& hint);

  // True while the latest map's first keyframe is not in the snapshots yet: the next frame should wait for it.
  bool awaits_first_keyframe(const Atlas& atlas) const;

 private:
  void AdoptSnapshot(const std::shared_ptr<const Atlas>& atlas);
  void RebuildLocalMap(KeyframeId reference);
  std::optional<Rigid3d> PreviousPose() const;
  void TrackKnownMap(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right, TrackingResult& result,
                     StageRecorder& stages);
  bool IsTrusted(const LocatedFrame& located, const LocalMap& local_map, int min_inliers) const;
  std::optional<LocatedFrame> LocateByMotion(std::int64_t stamp_ns, StageRecorder& stages);
  std::optional<LocatedFrame> LocateAnywhere(std::int64_t stamp_ns, const cv::Mat& left, StageRecorder& stages);
  std::optional<RecognisedFrame> RecogniseAnywhere(const Features& features) const;
  LocatedFrame LocateAgain(const cv::Mat& left, LocatedFrame thin, StageRecorder& stages);
  Recognition::Surroundings Surroundings() const;
  Recognition::Trust Trust(int min_inliers) const;
  std::optional<RecognisedFrame> Recognise(const Features& features, std::span<const KeyframeId> candidates,
                                           int min_inliers) const;
  LocatedFrame Enter(RecognisedFrame recognised);
  void EnterLargerMap(std::int64_t stamp_ns, const cv::Mat& left, RawKeyframe& keyframe, TrackingResult& result,
                      StageRecorder& stages);
  void Lose(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right, TrackingResult& result,
            StageRecorder& stages);
  Vector6d VelocityInto(std::int64_t stamp_ns, const Rigid3d& camera_from_map) const;
  void FinishTracked(std::int64_t stamp_ns, const LocatedFrame& located, TrackingResult& result);
  void HangBelowOwnKeyframe(TrackingResult& result) const;
  void HangBelowKeyframeUnderWay(TrackingResult& result) const;
  static void HangBelow(const RecentKeyframes::Place& keyframe, TrackingResult& result);
  void ConsiderKeyframe(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right,
                        const LocatedFrame& located, TrackingResult& result, StageRecorder& stages);
  void KeepFrame(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right, const LocatedFrame& located,
                 TrackingResult& result, StageRecorder& stages);
  RawKeyframe RawOf(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right,
                    const LocatedFrame& located) const;
  void PlaceAsTracked(const TrackingResult& result, RawKeyframe& keyframe) const;
  void Number(RawKeyframe& keyframe);
  double NearestView(const Rigid3d& camera_from_map, double median_depth) const;
  bool StartMap(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right, TrackingResult& result,
                StageRecorder& stages);
  // See tracker_monocular.cc.
  bool StartMonocularMap(std::int64_t stamp_ns, const cv::Mat& left, TrackingResult& result, StageRecorder& stages);
  void Adopt(const MonocularOpening& opening, std::shared_ptr<const KeyframeData> second, TrackingResult& result);
  void BeginMap();
  bool MappingIsBusy() const;

  const SessionId session_;
  const IdealCamera camera_;
  const TrackingOptions options_;
  KeyframeBuilder builder_;
  KeyframeDecision decision_;
  MonocularStart monocular_start_;
  TemplateStore templates_;
  Recognition recognition_;

  std::shared_ptr<const Atlas> atlas_;
  MapId map_;                  // none before the first map
  KeyframeId first_keyframe_;  // of map_
  KeyframeId reference_;       // of the local map
  LocalMap local_map_;
  std::optional<LatestFrame> previous_;
  ImagePyramid current_image_;
  ImagePyramid previous_image_;
  RecentKeyframes recent_keyframes_;
  std::shared_ptr<const KeyframeData> unrecognised_;  // of the present frame
  std::optional<PlaceHint> hint_;                     // while lost
  int frames_lost_ = 0;
  int frames_searched_ = 0;             // of the lost ones, those that showed something
  bool lacks_templates_ = false;        // of what is in view: a keyframe here would give them
  std::optional<RawKeyframe> closing_;  // of the latest frame, without a number
  std::uint32_t keyframes_made_ = 0;
  std::int64_t newest_keyframe_ns_ = 0;  // stamp
  std::uint32_t maps_made_ = 0;
};

}  // namespace pangaea
