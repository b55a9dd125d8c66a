#include "common/sensor/euroc_dataset.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/text.h"
#include "common/sensor/euroc_calibration.h"
#include "common/sensor/frame_list.h"
#include "common/sensor/image.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;

// Cameras that are triggered together differ by far less, frames by far more.
constexpr std::int64_t kPairTolerance_ns = 2'000'000;
constexpr std::array kTruthFolders = {"state_groundtruth_estimate0", "mocap0"};
constexpr std::size_t kTruthFields = 8;  // stamp, position, quaternion with w first; what follows is not used

// Counts the rows of a file that make no sense, and says so once.
class MalformedRows {
 public:
  void Add(int line) {
    if (count_++ == 0) first_ = line;
  }
  void Warn(const fs::path& file, std::vector<std::string>& warnings) const {
    if (count_ == 0) return;
    warnings.push_back(file.string() + ": " + std::to_string(count_) +
                       " malformed rows were skipped (the first is line " + std::to_string(first_) + ")");
  }

 private:
  std::size_t count_ = 0;
  int first_ = 0;
};

bool IsData(std::string_view line) { return !line.empty() && line.front() != '#'; }

fs::path RootOf(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(folder / "mav0", error) ? folder / "mav0" : folder;
}

Result<std::vector<StampedFile>> ReadImageList(const fs::path& camera_folder, std::vector<std::string>& warnings) {
  const fs::path file = camera_folder / "data.csv";
  const auto text = ReadTextFile(file);
  if (!text) return tl::make_unexpected(text.error());
  std::vector<StampedFile> images;
  MalformedRows malformed;
  ForEachLine(*text, [&](int number, std::string_view line) {
    if (!IsData(line)) return;
    const auto fields = SplitFields(line, ',');
    const auto stamp = ParseInteger(fields[0]);
    if (!stamp || *stamp < 0 || fields.size() < 2 || fields[1].empty()) return malformed.Add(number);
    images.push_back({*stamp, camera_folder / "data" / fields[1]});
  });
  malformed.Warn(file, warnings);
  if (images.empty()) return Fail(ErrorCode::kCorrupt, file.string() + ": lists no images");
  return KeepAscending(std::move(images), file.string(), warnings);
}

std::optional<StampedPose> ParseTruth(std::string_view line) {
  const auto fields = SplitFields(line, ',');
  if (fields.size() < kTruthFields) return std::nullopt;
  const auto stamp = ParseInteger(fields[0]);
  std::array<double, kTruthFields - 1> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto number = ParseNumber(fields[i + 1]);
    if (!number) return std::nullopt;
    numbers[i] = *number;
  }
  const Eigen::Quaterniond rotation(numbers[3], numbers[4], numbers[5], numbers[6]);
  if (!stamp || std::abs(rotation.norm() - 1.0) > 0.1) return std::nullopt;
  return StampedPose{*stamp, Rigid3d(rotation, {numbers[0], numbers[1], numbers[2]})};
}

std::vector<StampedPose> ReadGroundTruth(const fs::path& root, std::vector<std::string>& warnings) {
  for (const char* name : kTruthFolders) {
    const fs::path file = root / name / "data.csv";
    const auto text = ReadTextFile(file);
    if (!text) continue;
    std::vector<StampedPose> poses;
    MalformedRows malformed;
    ForEachLine(*text, [&](int number, std::string_view line) {
      if (!IsData(line)) return;
      const auto pose = ParseTruth(line);
      if (!pose) return malformed.Add(number);
      poses.push_back(*pose);
    });
    malformed.Warn(file, warnings);
    return KeepAscending(std::move(poses), file.string(), warnings);
  }
  return {};
}

// One image of another size is skipped when it is read; when all of them are, the calibration is of another camera.
Status CheckResolution(const EurocCamera& camera, const std::vector<StampedFile>& images) {
  const ImageSize calibrated{camera.lens.width, camera.lens.height};
  std::optional<ImageSize> other;
  for (const std::size_t i : {std::size_t{0}, images.size() / 2, images.size() - 1}) {
    const auto size = ReadImageSize(images[i].path);
    if (!size) continue;
    if (*size == calibrated) return {};
    other = *size;
  }
  if (!other) return {};
  return Fail(ErrorCode::kInvalidArgument,
              camera.file.string() + ": resolution is [" + std::to_string(calibrated.width) + ", " +
                  std::to_string(calibrated.height) + "], but the images are " + std::to_string(other->width) + " x " +
                  std::to_string(other->height) + "; allowed: the size of the images");
}

struct CameraStream {
  EurocCamera camera;
  std::vector<StampedFile> images;
};

Result<CameraStream> OpenCamera(const fs::path& folder, std::vector<std::string>& warnings) {
  auto camera = ReadEurocCamera(folder / "sensor.yaml");
  if (!camera) return tl::make_unexpected(camera.error());
  auto images = ReadImageList(folder, warnings);
  if (!images) return tl::make_unexpected(images.error());
  if (auto status = CheckResolution(*camera, *images); !status) return tl::make_unexpected(status.error());
  return CameraStream{std::move(*camera), std::move(*images)};
}

}  // namespace

bool IsEurocDataset(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(RootOf(folder) / "cam0", error);
}

Result<Dataset> OpenEurocDataset(const fs::path& folder, SensorKind kind) {
  const fs::path root = RootOf(folder);
  Dataset dataset;
  dataset.name = (root == folder ? root.parent_path() : folder).filename().string();
  dataset.layout = "EuRoC";
  auto left = OpenCamera(root / "cam0", dataset.warnings);
  if (!left) return tl::make_unexpected(left.error());
  dataset.rig.left = left->camera.lens;
  dataset.rig.body_from_left = left->camera.body_from_camera;
  if (kind == SensorKind::kStereo) {
    auto right = OpenCamera(root / "cam1", dataset.warnings);
    if (!right) return tl::make_unexpected(right.error());
    dataset.rig.right = right->camera.lens;
    dataset.rig.body_from_right = right->camera.body_from_camera;
    dataset.frames = PairByStamp(left->images, right->images, kPairTolerance_ns, dataset.warnings);
  } else {
    for (StampedFile& image : left->images) dataset.frames.push_back({image.stamp_ns, std::move(image.path), {}});
  }
  if (dataset.frames.empty()) {
    return Fail(ErrorCode::kCorrupt, root.string() + ": no image of cam0 has a partner of the same time in cam1");
  }
  dataset.ground_truth = ReadGroundTruth(root, dataset.warnings);
  return dataset;
}

}  // namespace pangaea
