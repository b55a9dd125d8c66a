#pragma once

#include <Eigen/Core>
#include <optional>

#include "agent/tracking/patch_template.h"
#include "common/features/patch_pyramid.h"
#include "common/geometry/ideal_camera.h"
#include "common/geometry/rigid3.h"

namespace pangaea {

struct PatchAlignmentOptions {
  int max_iterations = 12;       // of Gauss-Newton, per level; almost all patches need fewer than 6
  double converged_step = 0.03;  // pixels of the level: below the noise of the result
  double max_shift = 6.0;        // pixels of the level: what an 8 x 8 window can find
  double min_correlation = 0.8;  // zero-mean normalised cross-correlation of an accepted match
  // Smaller eigenvalue of the mean gradient matrix, (grey levels / pixel)^2: at 4, noise of 1.6 grey levels moves the
  // result by 0.15 pixels.
  double min_texture = 4.0;
};

struct AlignedPatch {
  Eigen::Vector2d pixel;     // full resolution
  int level = 0;             // on which it was found
  double correlation = 0.0;  // with the template, at the solution
};

// The affine map from pixels of the template's keyframe to pixels of the current image (both full resolution) around
// the landmark, for a surface parallel to the template's image plane.
// `point_in_template` is the landmark in the camera frame of the template's keyframe. Nothing when it is behind a
// camera.
std::optional<Eigen::Matrix2d> CurrentFromTemplate(const IdealCamera& camera, const Rigid3d& current_from_template,
                                                   const Eigen::Vector3d& point_in_template);

// False where the landmark is seen from the other side, or from so much further away or nearer that a template's crop
// holds no usable detail.
bool CanBeAligned(const Eigen::Matrix2d& current_from_template);

// Finds the template in the image near `predicted` by inverse-compositional Gauss-Newton on the shift of the affinely
// warped patch (Baker and Matthews 2004), gain and offset of the brightness removed. `coarse`: begin one level coarser,
// which doubles the basin. Nothing when it does not converge, leaves the image, or does not correlate.
std::optional<AlignedPatch> AlignPatch(const ImagePyramid& image, const PatchTemplate& patch,
                                       const Eigen::Matrix2d& current_from_template, const Eigen::Vector2d& predicted,
                                       bool coarse, const PatchAlignmentOptions& options);

}  // namespace pangaea
