#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/stamped_pose.h"
#include "common/sensor/frame_list.h"
#include "common/sensor/lens.h"

namespace pangaea {

// How the text tables of a layout are written. Lines that are empty or begin with # are no rows.
struct TableFormat {
  char separator = ',';
  bool stamps_in_seconds = false;        // decimal seconds; else whole nanoseconds
  bool quaternion_scalar_first = false;  // after stamp and position; else the scalar is last
};
inline constexpr TableFormat kEurocTables{.separator = ',', .quaternion_scalar_first = true};
inline constexpr TableFormat kTumTables{.separator = ' ', .stamps_in_seconds = true};

// Rows of pairs of a stamp and a file name. A row's image is its first pair whose name begins with `prefix`; names are
// relative to `folder`. Rows that make no sense or are out of order are left out, with one warning and a count.
Result<std::vector<StampedFile>> ReadImageTable(const std::filesystem::path& file, const TableFormat& format,
                                                const std::filesystem::path& folder, std::string_view prefix,
                                                std::vector<std::string>& warnings);

// Rows of stamp, position (metres) and quaternion; further fields are not used. Otherwise as above.
Result<std::vector<StampedPose>> ReadPoseTable(const std::filesystem::path& file, const TableFormat& format,
                                               std::vector<std::string>& warnings);

// One image of another size is skipped when it is read; when all of them are, the calibration (`calibration_file`) is
// of another camera.
Status CheckImageSizes(const std::vector<StampedFile>& images, const LensModel& lens,
                       const std::filesystem::path& calibration_file);

}  // namespace pangaea
