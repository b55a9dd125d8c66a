#pragma once

#include <Eigen/Core>

#include "agent/tracking/local_map.h"
#include "agent/tracking/patch_search.h"
#include "common/geometry/ideal_camera.h"
#include "common/geometry/rigid3.h"

namespace pangaea {

struct KeyframeDecisionOptions {
  // A keyframe is due when the tracked landmarks cover less than this share of the cells they covered at best since the
  // latest keyframe: the camera sees something new.
  double min_coverage_ratio = 0.80;
  // ... or when fewer than this share of the best count since the latest keyframe are tracked.
  double min_inlier_ratio = 0.60;
  // ... or when no keyframe of the local map is as near as this: distance as a share of the scene's median depth,
  double max_relative_distance = 0.18;
  // and turn of the optical axis, degrees. Beyond either a landmark's templates and descriptors age.
  double max_turn = 20.0;
  // A keyframe whose view is as near as this share of the two limits shows the same already: the image is poorer here,
  // and was so then. Without this a camera that goes to and fro in a known place would go on making keyframes.
  double known_view = 0.5;
  // A keyframe of another session is taken for so many times as far: it shows the place, but the session's frames share
  // what becomes of its own keyframes alone (docs/decisions/0029-frames-between-keyframes.md).
  double others_view = 2.0;
  // Frames between keyframes, unless tracking gets thin: neighbouring frames say nearly the same.
  int min_gap = 2;
  // With fewer landmarks tracked a keyframe is urgent: it may follow at once, even while mapping is busy.
  int urgent_inliers = 90;
  int grid_columns = 12;
  int grid_rows = 8;
};

// What a frame shows of the need for a keyframe.
struct KeyframeEvidence {
  int inliers = 0;
  int covered_cells = 0;
  double median_depth = 0.0;  // of the tracked landmarks, map units
};

KeyframeEvidence GatherEvidence(const IdealCamera& camera, const LocatedFrame& located, const LocalMap& local_map,
                                const KeyframeDecisionOptions& options);

// How far the view is from a keyframe's: the larger of distance and turn, each as a share of what is allowed.
double ViewDistance(const Rigid3d& camera_from_map, const Rigid3d& keyframe_from_map, double median_depth,
                    const KeyframeDecisionOptions& options);

// Decides, frame by frame, when a keyframe is due.
class KeyframeDecision {
 public:
  explicit KeyframeDecision(const KeyframeDecisionOptions& options) : options_(options) {}

  // To be called for every tracked frame. `nearest_view` is the smallest ViewDistance to a keyframe of the local map
  // (times others_view, where it is another session's) or to one that is on its way into it; `mapping_busy`: the latest
  // keyframe is not in the map yet.
  bool IsDue(const KeyframeEvidence& evidence, double nearest_view, bool mapping_busy);
  // Whether the latest frame is far enough behind the newest keyframe to be one.
  bool is_gap_over() const { return frames_since_ >= options_.min_gap; }
  // A keyframe was made from the latest frame.
  void Restart();

 private:
  KeyframeDecisionOptions options_;
  int best_inliers_ = 0;
  int best_cells_ = 0;
  int frames_since_ = 0;
};

}  // namespace pangaea
