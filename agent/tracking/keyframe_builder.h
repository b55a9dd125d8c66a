#pragma once

#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "agent/tracking/local_map.h"
#include "agent/tracking/patch_search.h"
#include "common/base/stage_recorder.h"
#include "common/features/orb_extractor.h"
#include "common/features/stereo_matcher.h"
#include "common/map/keyframe.h"

namespace pangaea {

// Gives the rectified right image of the frame at hand; an empty image where there is none (monocular, or a
// file that cannot be read). Called only where depth is wanted.
using RightImage = std::function<cv::Mat()>;

// A frame with everything a keyframe holds, and the landmark tracked at each keypoint (none where none).
struct BuiltKeyframe {
  std::shared_ptr<KeyframeData> data;
  std::vector<LandmarkId> landmarks;
  int keypoints_with_depth = 0;
};

// Extracts corners and descriptors where tracked landmarks do not cover the image, and stereo depth for all of them.
// One object per thread.
class KeyframeBuilder {
 public:
  KeyframeBuilder(const IdealCamera& camera, const OrbOptions& orb, const StereoOptions& stereo);

  // `located` may be null: nothing is tracked yet. Stages "tracking.extract" and "tracking.stereo".
  BuiltKeyframe Build(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right, const LocatedFrame* located,
                      const LocalMap& local_map, StageRecorder& stages);

  // A keyframe of a map's beginning: its keypoints begin with `fixed`, in order. Without depth. Stage
  // "tracking.extract".
  std::shared_ptr<KeyframeData> Describe(std::int64_t stamp_ns, const cv::Mat& left, std::span<const FixedPoint> fixed,
                                         StageRecorder& stages);
  // Corners and descriptors alone, to recognise a place by.
  Features Extract(const cv::Mat& left) { return extractor_.Extract(left); }

 private:
  IdealCamera camera_;
  OrbExtractor extractor_;
  StereoMatcher stereo_;
};

}  // namespace pangaea
