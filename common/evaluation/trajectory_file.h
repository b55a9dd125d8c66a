#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/stamped_pose.h"

namespace pangaea {

// The TUM format: one pose a line, "seconds tx ty tz qx qy qz qw", '#' opens a comment. Seconds have 9 decimals, so
// nanosecond stamps are exact both ways.
std::string FormatTrajectory(std::span<const StampedPose> poses);
Status WriteTrajectory(const std::filesystem::path& path, std::span<const StampedPose> poses);

// Poses in the order of the file. A malformed line is an error with file and line number.
Result<std::vector<StampedPose>> ReadTrajectory(const std::filesystem::path& path);
// The same from text; `name` stands for the file in messages.
Result<std::vector<StampedPose>> ParseTrajectory(const std::string& text, const std::string& name);

}  // namespace pangaea
