#include "common/sensor/euroc_dataset.h"

#include <array>
#include <string>
#include <utility>

#include "common/sensor/camera_chain.h"
#include "common/sensor/euroc_calibration.h"
#include "common/sensor/frame_list.h"
#include "common/sensor/recording_tables.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;

// Cameras that are triggered together differ by far less, frames by far more.
constexpr std::int64_t kPairTolerance_ns = 2'000'000;
constexpr std::array kTruthFolders = {"state_groundtruth_estimate0", "mocap0"};

fs::path RootOf(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(folder / "mav0", error) ? folder / "mav0" : folder;
}

// The cameras and the file that each of them is described in.
struct Calibration {
  CameraRig rig;
  fs::path left_file;
  fs::path right_file;
  bool is_chain = false;
};

Result<Calibration> ReadChain(const fs::path& file, SensorKind kind) {
  auto rig = ReadCameraChain(file, kind);
  if (!rig) return tl::make_unexpected(rig.error());
  return Calibration{std::move(*rig), file, file, true};
}

Result<Calibration> ReadCalibration(const fs::path& root, SensorKind kind, const fs::path& given) {
  if (!given.empty()) return ReadChain(given, kind);
  Calibration calibration;
  calibration.left_file = root / "cam0" / "sensor.yaml";
  calibration.right_file = root / "cam1" / "sensor.yaml";
  const fs::path chain = root.parent_path() / "dso" / "camchain.yaml";
  std::error_code error;
  if (!fs::exists(calibration.left_file, error) && fs::exists(chain, error)) return ReadChain(chain, kind);
  const auto left = ReadEurocCamera(calibration.left_file);
  if (!left) return tl::make_unexpected(left.error());
  calibration.rig.left = left->lens;
  calibration.rig.body_from_left = left->body_from_camera;
  if (kind == SensorKind::kMonocular) return calibration;
  const auto right = ReadEurocCamera(calibration.right_file);
  if (!right) return tl::make_unexpected(right.error());
  calibration.rig.right = right->lens;
  calibration.rig.body_from_right = right->body_from_camera;
  return calibration;
}

Result<std::vector<StampedFile>> ListImages(const fs::path& folder, const LensModel& lens, const fs::path& calibration,
                                            std::vector<std::string>& warnings) {
  auto images = ReadImageTable(folder / "data.csv", kEurocTables, folder / "data", "", warnings);
  if (!images) return images;
  if (auto status = CheckImageSizes(*images, lens, calibration); !status) return tl::make_unexpected(status.error());
  return images;
}

Status ListFrames(const fs::path& root, const Calibration& calibration, Dataset& dataset) {
  const CameraRig& rig = calibration.rig;
  const auto left = ListImages(root / "cam0", rig.left, calibration.left_file, dataset.warnings);
  if (!left) return tl::make_unexpected(left.error());
  if (!rig.right) {
    for (const StampedFile& image : *left) dataset.frames.push_back({image.stamp_ns, image.path, {}});
    return {};
  }
  const auto right = ListImages(root / "cam1", *rig.right, calibration.right_file, dataset.warnings);
  if (!right) return tl::make_unexpected(right.error());
  dataset.frames = PairByStamp(*left, *right, kPairTolerance_ns, dataset.warnings);
  if (!dataset.frames.empty()) return {};
  return Fail(ErrorCode::kCorrupt, root.string() + ": no image of cam0 has a partner of the same time in cam1");
}

std::vector<StampedPose> ReadGroundTruth(const fs::path& root, std::vector<std::string>& warnings) {
  for (const char* name : kTruthFolders) {
    auto poses = ReadPoseTable(root / name / "data.csv", kEurocTables, warnings);
    if (poses) return std::move(*poses);
  }
  return {};
}

}  // namespace

bool IsEurocDataset(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(RootOf(folder) / "cam0", error);
}

Result<Dataset> OpenEurocDataset(const fs::path& folder, SensorKind kind, const fs::path& calibration_file,
                                 GroundTruth truth) {
  const fs::path root = RootOf(folder);
  const auto calibration = ReadCalibration(root, kind, calibration_file);
  if (!calibration) return tl::make_unexpected(calibration.error());
  Dataset dataset;
  dataset.name = (root == folder ? root.parent_path() : folder).filename().string();
  dataset.layout = calibration->is_chain && calibration_file.empty() ? "TUM-VI" : "EuRoC";
  dataset.rig = calibration->rig;
  if (auto status = ListFrames(root, *calibration, dataset); !status) return tl::make_unexpected(status.error());
  if (truth == GroundTruth::kRead) dataset.ground_truth = ReadGroundTruth(root, dataset.warnings);
  return dataset;
}

}  // namespace pangaea
