#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/similarity3.h"
#include "common/geometry/stamped_pose.h"

namespace pangaea {

struct AbsoluteErrorOptions {
  // Sim(3) instead of SE(3): for monocular trajectories, whose scale is free.
  bool with_scale = false;
  // Ground truth is interpolated between two samples at most this far apart, seconds. EuRoC has 0.005; 0.06 admits
  // truth at 20 Hz, where the interpolation of a flight is good to a millimetre.
  double max_truth_gap_s = 0.06;
  // A sample this near to a stamp is taken as it is, seconds.
  double stamp_tolerance_s = 0.001;

  Status Check() const;
};

// What a session's trajectory is compared with.
struct EvaluatedTrajectory {
  std::string name;
  std::vector<StampedPose> estimate;  // of the body, in the map's frame
  std::vector<StampedPose> truth;     // of the body, in a world frame common to all sessions evaluated together
  // The point on the body whose positions are compared: identity for the body's origin, body_from_camera for the left
  // camera (published figures differ in this).
  Rigid3d body_from_evaluated;
  // Frames of the dataset: the denominator of coverage. 0: unknown.
  std::size_t dataset_frames = 0;
};

struct ErrorStatistics {
  std::size_t count = 0;  // poses compared
  double rms = 0.0;       // metres, like the rest
  double mean = 0.0;
  double median = 0.0;
  double max = 0.0;
  double rotation_rms = 0.0;  // degrees, of the orientations after the same alignment
};

struct SessionError {
  std::string name;
  ErrorStatistics error;
  std::size_t estimated = 0;       // poses of the trajectory, with or without truth
  std::size_t dataset_frames = 0;  // 0: unknown
  double coverage = 0.0;           // estimated / dataset_frames, 0 to 1; 0 where unknown
  double path_length = 0.0;        // of the truth at the compared stamps, metres
};

// The error of one or several trajectories that live in one map, under one alignment for all of them.
struct AbsoluteError {
  Similarity3d truth_from_estimate;
  std::vector<SessionError> sessions;
  ErrorStatistics error;  // over all poses of all sessions
  double coverage = 0.0;  // over all sessions
};

// Poses of `truth` (ascending by stamp) at `stamp_ns`; nothing outside of it or in a gap.
std::optional<Rigid3d> InterpolatePose(std::span<const StampedPose> truth, std::int64_t stamp_ns,
                                       const AbsoluteErrorOptions& options);

// The absolute trajectory error (Sturm et al. 2012) after a closed-form alignment of the positions (Horn 1987). Where
// those leave the rotation open (a camera that stands still or goes straight on), the orientations decide it, and the
// scale is 1. Fails when no pose has ground truth.
Result<AbsoluteError> EvaluateAbsoluteError(std::span<const EvaluatedTrajectory> sessions,
                                            const AbsoluteErrorOptions& options = {});

}  // namespace pangaea
