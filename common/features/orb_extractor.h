#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>

#include "common/base/result.h"
#include "common/geometry/keypoint.h"

namespace pangaea {

struct OrbOptions {
  // Keypoints wanted in all, the fixed ones included. 1000 cover a 752 x 480 image well.
  int features = 1000;
  // Grey levels by which 9 neighbouring pixels of the circle must differ from the centre (FAST). Corners above the
  // high threshold are preferred; those between the two serve only where an area has too few of these.
  int high_threshold = 20;
  int low_threshold = 7;
  // A new corner keeps this far from every fixed point and from other new corners of its octave, in pixels of its
  // octave.
  float min_distance = 6.0F;
  // Two new corners of different octaves closer than this (pixels of the coarser octave) are one corner: the finer one
  // is kept. 0 keeps both: a corner seen from nearer or farther is then found again in another octave.
  float same_corner_distance = 0.0F;

  Status Check() const;
};

// A point whose position is known already: a tracked landmark. Full-resolution pixels; octave 0 to kOctaves - 1.
struct FixedPoint {
  float u = 0.0F;
  float v = 0.0F;
  int octave = 0;
};

// Oriented FAST corners with rotated BRIEF descriptors (Rublee et al. 2011: ORB), spread evenly over image and octaves.
// The result depends on the image, the fixed points and the options alone. Keeps buffers: one object per thread.
class OrbExtractor {
 public:
  // Options must have passed Check().
  explicit OrbExtractor(OrbOptions options = {});
  ~OrbExtractor();
  OrbExtractor(OrbExtractor&&) noexcept;
  OrbExtractor& operator=(OrbExtractor&&) noexcept;

  // `image` is CV_8UC1, the rectified left image. The keypoints begin with the fixed points, all of them, in order and
  // at their positions (quantised); then new corners with sub-pixel positions follow up to OrbOptions::features. All
  // have orientation and descriptor; near the image's edge these see a mirrored margin. u_right is unknown in all.
  Features Extract(const cv::Mat& image, std::span<const FixedPoint> fixed = {});

 private:
  struct Workspace;
  OrbOptions options_;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace pangaea
