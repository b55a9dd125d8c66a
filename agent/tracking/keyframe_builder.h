#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "agent/mapping/keyframe_candidate.h"
#include "agent/tracking/local_map.h"
#include "agent/tracking/patch_search.h"
#include "common/base/stage_recorder.h"
#include "common/features/orb_extractor.h"
#include "common/features/stereo_matcher.h"
#include "common/map/keyframe.h"

namespace pangaea {

// Gives the rectified right image of one frame; an empty image where there is none (monocular, or a file that cannot be
// read). Called only where depth is wanted, on the thread that wants it. Stage "decode".
using RightImage = std::function<cv::Mat(StageRecorder&)>;

// A tracked frame that is worth keeping, as tracking leaves it: its corners, descriptors and depth are computed where
// it enters the map.
struct RawKeyframe {
  KeyframeId id;
  MapId map;
  std::int64_t stamp_ns = 0;
  cv::Mat left;  // rectified; nobody writes to it any more
  RightImage right;
  std::vector<FixedPoint> tracked;    // where landmarks were found
  std::vector<LandmarkId> landmarks;  // the landmark of each
  std::vector<float> depths;          // that the map predicts for each, map units
  KeyframeId reference;               // as in KeyframeCandidate
  Rigid3d camera_from_reference;
  ReferenceScale reference_scale;
  TrackedArrival arrival;
};

// What tracking found in a frame, as the raw keyframe's points.
void TakeTracked(const LocatedFrame& located, const LocalMap& local_map, RawKeyframe& keyframe);

// Extracts corners and descriptors where tracked landmarks do not cover the image, and stereo depth for all of them.
// The result depends on what is given alone. One object per thread.
class KeyframeBuilder {
 public:
  KeyframeBuilder(const IdealCamera& camera, const OrbOptions& orb, const StereoOptions& stereo);

  // The candidate that a raw keyframe becomes. Stages "keyframe.extract" and "keyframe.stereo".
  KeyframeCandidate Build(const RawKeyframe& keyframe, StageRecorder& stages);
  // What a frame shows; its keypoints begin with `fixed`, in order, at `depths` (map units) as far as these are
  // predicted. Stages as above; without a right image it has no depth.
  std::shared_ptr<KeyframeData> Describe(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right,
                                         std::span<const FixedPoint> fixed, std::span<const float> depths,
                                         StageRecorder& stages);
  // Corners and descriptors alone, to recognise a place by.
  Features Extract(const cv::Mat& left, std::span<const FixedPoint> fixed = {}) {
    return extractor_.Extract(left, fixed);
  }

 private:
  IdealCamera camera_;
  OrbExtractor extractor_;
  StereoMatcher stereo_;
};

}  // namespace pangaea
