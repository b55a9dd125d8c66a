#pragma once

#include "agent/tracking/keyframe_decision.h"
#include "agent/tracking/local_map.h"
#include "agent/tracking/monocular_start.h"
#include "agent/tracking/patch_search.h"
#include "agent/tracking/pose_observability.h"
#include "agent/tracking/recognition.h"
#include "agent/tracking/sparse_alignment.h"
#include "common/base/result.h"
#include "common/features/orb_extractor.h"
#include "common/features/stereo_matcher.h"
#include "common/geometry/ideal_camera.h"

namespace pangaea {

struct TrackingOptions {
  int min_inliers = 20;  // landmarks that a tracked frame's pose rests on, at least
  // ... and the share of the landmarks found in the image that agree with it: at a true pose nearly all do, at a wrong
  // one patches are found by chance and contradict each other.
  double min_agreement = 0.5;
  int weak_inliers = 60;  // with fewer the frame is searched again, and compared with what descriptors recognise
  int min_recovery_inliers = 30;         // ... after the camera was lost: a wrong place must not pass
  int min_start_points = 100;            // keypoints with depth that a new map starts from, at least
  double start_depth_baselines = 120.0;  // depth beyond so many baselines gives it no landmark
  // Lost frames that show something before the map is left and a new one started; half a second at 20 Hz. A known place
  // is mostly recognised in the first of them. Dark ones do not count: the place may be known when the light is back.
  int frames_until_new_map = 10;
  // Further ones where somebody else knows the place: what is around it is on its way.
  int frames_for_hint = 20;
  int frames_predicted = 5;           // lost frames during which the latest motion still predicts the pose
  int pyramid_levels = 5;             // factor-2 levels for patch tracking
  std::size_t max_templates = 12000;  // landmarks with templates kept, about 1.2 KB a view
  std::size_t template_images = 6;    // newest keyframes whose images are kept to cut templates from
  double new_view_angle = 25.0;       // degrees from all templates of a landmark that call for one more
  KeyframeDecisionOptions keyframes;  // stereo
  // Without stereo depth landmarks come from motion between keyframes alone: these follow more closely.
  KeyframeDecisionOptions monocular_keyframes{
      .min_coverage_ratio = 0.85, .min_inlier_ratio = 0.75, .max_relative_distance = 0.10};
  LocalMapOptions local_map;
  PatchSearchOptions search;
  SparseAlignmentOptions sparse_alignment;
  MonocularStartOptions monocular_start;
  ObservabilityOptions observability;
  RecognitionOptions recognition;
  // Stereo places the camera as well with 850 keypoints as with 1000, and a keyframe then fits into 45 kB.
  OrbOptions orb{.features = 850};
  // In place of orb.features for one camera: what it maps must be found twice, and its maps begin with the corners of
  // one frame.
  int monocular_features = 1000;
  StereoOptions stereo;

  // With the options of this kind of camera in place of the others': two cameras or one.
  TrackingOptions ForCamera(const IdealCamera& camera) const;

  // Says which option is out of which range.
  Status Check() const;
};

}  // namespace pangaea
