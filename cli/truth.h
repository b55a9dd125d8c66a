#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/stamped_pose.h"

namespace pangaea {

// What a recording says about itself: where its body was, and how many frames it has.
struct Truth {
  std::string name;                           // of the session it belongs to
  std::string source;                         // folder or file, for messages
  std::vector<StampedPose> poses;             // of the body; empty where the recording has no ground truth
  std::size_t frames = 0;                     // 0: unknown
  std::optional<Rigid3d> body_from_camera{};  // the left one; unknown for a trajectory file
  Eigen::Vector3d up = {0.0, 0.0, 1.0};       // in the world frame of `poses`
  bool shares_world = true;                   // with other recordings; false: the recording's own frame
};

// Reads DATASET (a folder of a known layout) or FILE.tum. NAME=DATASET says which session it belongs to, where that is
// not called like the folder.
Result<Truth> ReadTruth(const std::string& argument);
Result<std::vector<Truth>> ReadTruths(const std::vector<std::string>& arguments);

// What `--help` says of the argument.
inline constexpr const char* kTruthHelp =
    "Where it really was: the dataset's folder (EuRoC, TUM-VI, KITTI, TUM RGB-D) or a TUM file; repeatable";

}  // namespace pangaea
