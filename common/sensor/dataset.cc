#include "common/sensor/dataset.h"

#include <array>

#include "common/sensor/euroc_dataset.h"
#include "common/sensor/kitti_dataset.h"
#include "common/sensor/tum_rgbd_dataset.h"

namespace pangaea {
namespace {

// One way to lay out a recording on disk. A new layout is a new line here.
struct Layout {
  bool (*recognises)(const std::filesystem::path&);
  Result<Dataset> (*open)(const std::filesystem::path& folder, SensorKind, const std::filesystem::path& calibration,
                          GroundTruth truth);
  const char* description;
};

constexpr std::array kLayouts = {
    Layout{&IsEurocDataset, &OpenEurocDataset, "EuRoC and TUM-VI (a folder with mav0/cam0/data.csv)"},
    Layout{&IsKittiDataset, &OpenKittiDataset, "KITTI odometry (a folder with calib.txt, times.txt and image_0)"},
    Layout{&IsTumRgbdDataset, &OpenTumRgbdDataset, "TUM RGB-D (a folder with rgb.txt and rgb)"},
};

// "a/b/" names b like "a/b" does.
std::filesystem::path WithoutTrailingSlash(const std::filesystem::path& folder) {
  const std::filesystem::path normal = std::filesystem::absolute(folder).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

}  // namespace

Result<Dataset> OpenDataset(const std::filesystem::path& folder, SensorKind kind,
                            const std::filesystem::path& calibration, GroundTruth truth) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    return Fail(ErrorCode::kNotFound, folder.string() + ": there is no such folder");
  }
  std::string known;
  for (const Layout& layout : kLayouts) {
    if (layout.recognises(folder)) return layout.open(WithoutTrailingSlash(folder), kind, calibration, truth);
    known += (known.empty() ? "" : "; ") + std::string(layout.description);
  }
  return Fail(ErrorCode::kUnsupported, folder.string() + ": not a dataset of a known layout; known are: " + known);
}

}  // namespace pangaea
