#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>

#include "common/base/result.h"
#include "common/geometry/ideal_camera.h"
#include "common/geometry/keypoint.h"

namespace pangaea {

struct StereoOptions {
  // Nearest depth searched, in baselines: the largest disparity is focal_x / this. 3 is 0.33 m for a baseline of 11 cm.
  double min_depth_baselines = 3.0;
  // Smaller disparities (pixels) say nothing about depth: such points stay without u_right.
  double min_disparity = 0.5;
  // Around a predicted disparity the search covers +- (this share of it + the margin in pixels).
  double predicted_share = 0.2;
  double predicted_margin = 4.0;
  // The right image's rows may be off by this many pixels (rectification error).
  int row_tolerance = 1;
  // Mean absolute gradient along the row, grey levels per pixel, that a patch needs: less is noise or an edge along the
  // row.
  double min_texture = 2.0;
  // The best matching cost must be below this share of the best cost elsewhere on the row: repeated texture is refused.
  double uniqueness = 0.9;
  // The best matching cost as a share of the patch's texture (its cost against a blank wall). Unrelated patches are at
  // 1 and above; a floor at a slant comes near 0.8.
  double max_difference = 0.8;
  // The match from right to left must come back to within this many pixels (of the level searched).
  int consistency = 1;
  // Normalised correlation of the aligned patches.
  double min_correlation = 0.85;

  Status Check() const;
};

// How a call of Match ended, keypoint by keypoint.
struct StereoStatistics {
  int matched = 0;
  int no_texture = 0;
  int ambiguous = 0;     // another place on the row looks alike
  int inconsistent = 0;  // the way back leads elsewhere
  int not_aligned = 0;   // no sub-pixel alignment, or poor correlation after it
  int out_of_range = 0;  // too near the image's edge, or the disparity is below the minimum
};

// Finds keypoints of the left image in the right one by comparing patches along the row: no corners of the right image
// are needed. Keeps buffers: one object per thread.
class StereoMatcher {
 public:
  // Options must have passed Check().
  explicit StereoMatcher(StereoOptions options = {});
  ~StereoMatcher();
  StereoMatcher(StereoMatcher&&) noexcept;
  StereoMatcher& operator=(StereoMatcher&&) noexcept;

  // Sets u_right of every keypoint: the column of its match in the right image, quantised, with
  // u - u_right >= min_disparity; -1 where there is no reliable match. `left` and `right` are CV_8UC1, rectified, of
  // the camera's size; the camera must be stereo. `predicted_depth` is empty, or one depth (metres along the optical
  // axis) per keypoint, <= 0 where unknown; where known it narrows the search.
  StereoStatistics Match(const cv::Mat& left, const cv::Mat& right, const IdealCamera& camera,
                         std::span<Keypoint> keypoints, std::span<const float> predicted_depth = {});

 private:
  struct Workspace;
  StereoOptions options_;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace pangaea
