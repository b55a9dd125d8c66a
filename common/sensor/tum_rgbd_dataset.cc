#include "common/sensor/tum_rgbd_dataset.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "common/sensor/camera_chain.h"
#include "common/sensor/frame_list.h"
#include "common/sensor/recording_tables.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kColourFolder = "rgb/";

struct PublishedCamera {
  std::string_view name;  // in the name of a sequence
  double focal_x, focal_y, center_x, center_y;
  std::array<double, 5> coefficients;
};

// "Intrinsic camera calibration of the Kinect", file formats page of the benchmark: RGB cameras, 640 x 480. The images
// of the third are undistorted already.
constexpr std::array kPublishedCameras = {
    PublishedCamera{"freiburg1", 517.3, 516.5, 318.6, 255.3, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}},
    PublishedCamera{"freiburg2", 520.9, 521.0, 325.1, 249.7, {0.2312, -0.7849, -0.0033, -0.0001, 0.9172}},
    PublishedCamera{"freiburg3", 535.4, 539.2, 320.1, 247.6, {}},
};

struct Calibration {
  CameraRig rig;
  fs::path source;  // for messages
};

Result<Calibration> ReadCalibration(const fs::path& folder, const fs::path& given) {
  const fs::path in_folder = folder / "calibration.yaml";
  std::error_code error;
  if (!given.empty() || fs::exists(in_folder, error)) {
    const fs::path& file = given.empty() ? in_folder : given;
    auto rig = ReadCameraChain(file, SensorKind::kMonocular);
    if (!rig) return tl::make_unexpected(rig.error());
    return Calibration{std::move(*rig), file};
  }
  const std::string name = folder.filename().string();
  const auto published = std::ranges::find_if(
      kPublishedCameras, [&](const PublishedCamera& camera) { return name.find(camera.name) != std::string::npos; });
  if (published == kPublishedCameras.end()) {
    return Fail(ErrorCode::kNotFound, folder.string() +
                                          ": the camera is unknown; allowed: a folder whose name contains freiburg1, "
                                          "freiburg2 or freiburg3, or a file calibration.yaml in it");
  }
  CameraRig rig;
  rig.left = {.kind = LensKind::kRadialTangential,
              .width = 640,
              .height = 480,
              .focal_x = published->focal_x,
              .focal_y = published->focal_y,
              .center_x = published->center_x,
              .center_y = published->center_y,
              .coefficients = published->coefficients};
  return Calibration{rig, "published calibration of " + std::string(published->name)};
}

Result<std::vector<StampedFile>> ListImages(const fs::path& folder, std::vector<std::string>& warnings) {
  std::error_code error;
  const fs::path plain = folder / "rgb.txt";
  const fs::path list = fs::exists(plain, error) ? plain : folder / "associations.txt";
  return ReadImageTable(list, kTumTables, folder, kColourFolder, warnings);
}

}  // namespace

bool IsTumRgbdDataset(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / "rgb.txt", error) || fs::exists(folder / "associations.txt", error);
}

Result<Dataset> OpenTumRgbdDataset(const fs::path& folder, SensorKind kind, const fs::path& calibration_file,
                                   GroundTruth truth) {
  if (kind == SensorKind::kStereo) {
    return Fail(ErrorCode::kUnsupported,
                folder.string() + ": a TUM RGB-D recording has one colour camera; allowed: a monocular sensor");
  }
  const auto calibration = ReadCalibration(folder, calibration_file);
  if (!calibration) return tl::make_unexpected(calibration.error());
  Dataset dataset;
  dataset.name = folder.filename().string();
  dataset.layout = "TUM RGB-D";
  dataset.rig = calibration->rig;
  auto images = ListImages(folder, dataset.warnings);
  if (!images) return tl::make_unexpected(images.error());
  if (auto status = CheckImageSizes(*images, dataset.rig.left, calibration->source); !status) {
    return tl::make_unexpected(status.error());
  }
  for (StampedFile& image : *images) dataset.frames.push_back({image.stamp_ns, std::move(image.path), {}});
  const fs::path file = folder / "groundtruth.txt";
  std::error_code error;
  if (truth == GroundTruth::kLeave || !fs::exists(file, error)) return dataset;
  auto poses = ReadPoseTable(file, kTumTables, dataset.warnings);
  if (poses) dataset.ground_truth = std::move(*poses);
  return dataset;
}

}  // namespace pangaea
