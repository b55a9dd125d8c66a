#pragma once

#include <opencv2/core/mat.hpp>

#include "common/base/result.h"
#include "common/geometry/ideal_camera.h"
#include "common/geometry/rigid3.h"
#include "common/sensor/camera_rig.h"
#include "common/sensor/sensor_kind.h"

namespace pangaea {

struct RectifierOptions {
  // The focal length of the ideal camera is the shortest that leaves no black border, but at least this part of the
  // real one: below it the centre of the image would lose detail to gain field of view. Ratio, (0, 4].
  double min_focal_ratio = 0.9;

  Status Check() const;
};

// Makes of real images those of an IdealCamera of the same size: undistorted, for stereo also row-aligned with equal
// focal lengths and centres. Immutable after Create; all member functions may be called from any thread at once.
class Rectifier {
 public:
  // A monocular sensor uses the left camera alone and keeps its orientation. Fails where the rig cannot be rectified:
  // no right camera for stereo, or one that is not to the right of the left one, or sizes that differ.
  static Result<Rectifier> Create(const CameraRig& rig, SensorKind kind, const RectifierOptions& options = {});

  const IdealCamera& camera() const { return camera_; }
  // Pose of the ideal left camera in the body frame.
  const Rigid3d& body_from_camera() const { return body_from_camera_; }

  // 8-bit grey images of the real cameras' size, else PANGAEA_CHECK. Where nothing changes the image itself is returned
  // (shared, not copied). Pixels that no source pixel covers are black.
  cv::Mat RectifyLeft(const cv::Mat& image) const { return Remap(image, left_); }
  cv::Mat RectifyRight(const cv::Mat& image) const { return Remap(image, right_); }

 private:
  // Source coordinates of each target pixel in steps of 1/32 pixel; empty where source and target are the same.
  struct RemapTable {
    cv::Mat whole;     // CV_16SC2
    cv::Mat fraction;  // CV_16UC1
  };
  friend class RectifierBuilder;

  Rectifier() = default;
  cv::Mat Remap(const cv::Mat& image, const RemapTable& table) const;

  IdealCamera camera_;
  Rigid3d body_from_camera_;
  RemapTable left_;
  RemapTable right_;
};

}  // namespace pangaea
