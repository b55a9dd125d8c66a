#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/stamped_pose.h"
#include "common/sensor/dataset.h"

namespace pangaea {

// An image of one camera and when it was taken.
struct StampedFile {
  std::int64_t stamp_ns = 0;
  std::string path;
};

// Keeps as many items as can be kept with ascending stamps (a longest increasing subsequence), so that one stray stamp
// costs one item and not all that follow it. Adds one warning with the count of what was left out.
std::vector<StampedFile> KeepAscending(std::vector<StampedFile> items, const std::string& where,
                                       std::vector<std::string>& warnings);
std::vector<StampedPose> KeepAscending(std::vector<StampedPose> items, const std::string& where,
                                       std::vector<std::string>& warnings);

// Left and right images whose stamps differ by at most `tolerance_ns`, nearest first. Both lists ascend. Adds one
// warning with the count of images that found no partner.
std::vector<DatasetFrame> PairByStamp(const std::vector<StampedFile>& left, const std::vector<StampedFile>& right,
                                      std::int64_t tolerance_ns, std::vector<std::string>& warnings);

}  // namespace pangaea
