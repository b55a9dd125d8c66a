#pragma once

#include <Eigen/Core>
#include <vector>

#include "agent/tracking/local_map.h"
#include "agent/tracking/patch_alignment.h"
#include "common/estimation/pose_refinement.h"

namespace pangaea {

struct PatchSearchOptions {
  int max_landmarks = 300;  // looked for in a frame; the pose gains little from more
  int scouts = 70;          // looked for first, with the wide basin, to correct the predicted pose
  int grid_columns = 12;    // matches are spread over cells of about 60 x 60 pixels at 752 x 480
  int grid_rows = 8;
  double border = 12.0;          // pixels of the image's edge without landmarks: windows must fit
  double min_view_cosine = 0.5;  // of the angle between a template's view and the present one (60 degrees)
  // Standard deviation of an aligned patch, pixels of its pyramid level. The landmark's own uncertainty comes on top.
  double patch_sigma = 0.5;
  // ... up to this factor of the variance: beyond it the landmark still tells the rotation.
  double max_prediction_variance = 100.0;
  int min_scouts = 12;  // with fewer found the prediction is not corrected
  PatchAlignmentOptions alignment;
  PoseRefinementOptions refinement;
};

// A landmark found in the frame.
struct LandmarkMatch {
  int landmark = 0;       // index into LocalMap::landmarks
  Eigen::Vector2d pixel;  // full resolution; the pose rests on it less what LocalLandmark::latest_sighting expects
  int octave = 0;         // the template's octave as it appears in this frame
  double sigma = 1.0;     // pixels
  double correlation = 0.0;
};

struct LocatedFrame {
  RefinedPose pose;
  std::vector<LandmarkMatch> matches;  // the inliers of the pose
  int searched = 0;                    // landmarks that were looked for
  int found = 0;                       // ... and found, inliers or not
};

// Looks for the local map's landmarks in an image and refines the pose on what it finds: a few well-spread scouts
// first, the others where the corrected pose expects them. Updates the landmarks' `tracked` and `failures`.
// Nothing when there is no pose on options.refinement.min_inliers.
std::optional<LocatedFrame> LocateFrame(const ImagePyramid& image, const IdealCamera& camera,
                                        const Rigid3d& predicted_camera_from_map, LocalMap& local_map,
                                        const PatchSearchOptions& options);

}  // namespace pangaea
