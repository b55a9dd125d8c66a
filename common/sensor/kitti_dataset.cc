#include "common/sensor/kitti_dataset.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/text.h"
#include "common/sensor/camera_chain.h"
#include "common/sensor/frame_list.h"
#include "common/sensor/image.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMatrixNumbers = 12;    // three rows of four
constexpr double kRotationTolerance = 1e-2;   // the files hold seven digits
constexpr double kSameFocalTolerance = 1e-6;  // relative
constexpr std::size_t kSizeSamples = 5;       // images whose size is looked at
constexpr std::size_t kSizeStride = 1000003;  // a prime: visits every frame once, near ones far apart
constexpr std::array kImageEndings = {".png", ".jpg"};

using Matrix34 = Eigen::Matrix<double, 3, 4>;

std::optional<Matrix34> ParseMatrix(std::string_view text) {
  const auto fields = SplitFields(text, ' ');
  if (fields.size() != kMatrixNumbers) return std::nullopt;
  Matrix34 matrix;
  for (std::size_t i = 0; i < kMatrixNumbers; ++i) {
    const auto number = ParseNumber(fields[i]);
    if (!number) return std::nullopt;
    matrix(static_cast<int>(i / 4), static_cast<int>(i % 4)) = *number;
  }
  return matrix;
}

// The projection matrix "P0: ..." of calib.txt: focal lengths and centre in pixels, and focal length times offset.
Result<Matrix34> ReadProjection(const fs::path& file, std::string_view text, std::string_view key) {
  std::optional<Matrix34> matrix;
  int line_number = 0;
  ForEachLine(text, [&](int number, std::string_view line) {
    if (!line.starts_with(key)) return;
    line_number = number;
    matrix = ParseMatrix(line.substr(key.size()));
  });
  const std::string allowed = "; allowed: 12 finite numbers, focal lengths and centre greater than 0";
  if (line_number == 0) {
    return Fail(ErrorCode::kInvalidArgument, file.string() + ": the key " + std::string(key) + " is missing" + allowed);
  }
  const bool usable =
      matrix && (*matrix)(0, 0) > 0.0 && (*matrix)(1, 1) > 0.0 && (*matrix)(0, 2) > 0.0 && (*matrix)(1, 2) > 0.0;
  if (usable) return *matrix;
  return Fail(ErrorCode::kInvalidArgument, file.string() + ":" + std::to_string(line_number) + ": " + std::string(key) +
                                               " is not a projection matrix" + allowed);
}

LensModel LensFrom(const Matrix34& projection, ImageSize size) {
  LensModel lens;
  lens.width = size.width;
  lens.height = size.height;
  lens.focal_x = projection(0, 0);
  lens.focal_y = projection(1, 1);
  lens.center_x = projection(0, 2);
  lens.center_y = projection(1, 2);
  return lens;
}

Result<CameraRig> ReadRig(const fs::path& folder, ImageSize size, SensorKind kind) {
  const fs::path file = folder / "calib.txt";
  const auto text = ReadTextFile(file);
  if (!text) return tl::make_unexpected(text.error());
  const auto left = ReadProjection(file, *text, "P0:");
  if (!left) return tl::make_unexpected(left.error());
  CameraRig rig;
  rig.left = LensFrom(*left, size);
  rig.already_rectified = true;
  if (kind == SensorKind::kMonocular) return rig;
  const auto right = ReadProjection(file, *text, "P1:");
  if (!right) return tl::make_unexpected(right.error());
  const Eigen::Matrix3d difference = right->leftCols<3>() - left->leftCols<3>();
  const double baseline = ((*left)(0, 3) - (*right)(0, 3)) / (*left)(0, 0);
  if (difference.norm() > kSameFocalTolerance * (*left)(0, 0) || baseline <= 0.0) {
    return Fail(
        ErrorCode::kInvalidArgument,
        file.string() + ": P0 and P1 are not a rectified pair; allowed: equal but for a negative fourth number in P1");
  }
  rig.right = rig.left;
  rig.body_from_right = Rigid3d(Eigen::Quaterniond::Identity(), {baseline, 0.0, 0.0});
  return rig;
}

fs::path ImagePath(const fs::path& folder, std::size_t index, const char* ending) {
  char name[32];
  std::snprintf(name, sizeof(name), "%06zu%s", index, ending);
  return folder / name;
}

// Stamps of times.txt, line by line. A malformed line keeps its number, so that images and poses stay matched.
Result<std::vector<std::optional<std::int64_t>>> ReadTimes(const fs::path& file) {
  const auto text = ReadTextFile(file);
  if (!text) return tl::make_unexpected(text.error());
  std::vector<std::optional<std::int64_t>> times;
  ForEachLine(*text, [&](int, std::string_view line) { times.push_back(ParseSeconds(line)); });
  while (!times.empty() && !times.back()) times.pop_back();
  if (times.empty()) return Fail(ErrorCode::kCorrupt, file.string() + ": holds no times");
  return times;
}

using Poses = std::vector<std::optional<Rigid3d>>;  // by frame; none where the row is malformed

Poses ReadPoses(const fs::path& file) {
  Poses poses;
  const auto text = ReadTextFile(file);
  if (!text) return poses;
  ForEachLine(*text, [&](int, std::string_view line) {
    const auto matrix = ParseMatrix(line);
    const bool is_motion =
        matrix && (matrix->leftCols<3>() * matrix->leftCols<3>().transpose() - Eigen::Matrix3d::Identity()).norm() <
                      kRotationTolerance;
    poses.push_back(
        is_motion ? std::optional(Rigid3d(Eigen::Quaterniond(Eigen::Matrix3d(matrix->leftCols<3>())), matrix->col(3)))
                  : std::nullopt);
  });
  while (!poses.empty() && !poses.back()) poses.pop_back();
  return poses;
}

// calib.txt has no image size: it is the one that most of a few images spread over the recording have.
Result<ImageSize> FindImageSize(const std::vector<DatasetFrame>& frames) {
  std::vector<ImageSize> sizes;
  Error error{ErrorCode::kNotFound, "no images"};
  for (std::size_t i = 0; i < frames.size() && sizes.size() < kSizeSamples; ++i) {
    const auto size = ReadImageSize(frames[i * kSizeStride % frames.size()].left);
    if (size) {
      sizes.push_back(*size);
    } else if (i == 0) {
      error = size.error();
    }
  }
  if (sizes.empty()) return Fail(error.code, error.message + " (and none of the others can be read)");
  return *std::ranges::max_element(sizes, {}, [&](const ImageSize& size) { return std::ranges::count(sizes, size); });
}

void ListFrames(const fs::path& folder, SensorKind kind, const std::vector<std::optional<std::int64_t>>& times,
                const Poses& poses, Dataset& dataset) {
  std::error_code error;
  const bool is_png = fs::exists(ImagePath(folder / "image_0", 0, kImageEndings[0]), error) ||
                      !fs::exists(ImagePath(folder / "image_0", 0, kImageEndings[1]), error);
  const char* ending = is_png ? kImageEndings[0] : kImageEndings[1];
  const bool stereo = kind == SensorKind::kStereo;
  std::vector<StampedFile> images;
  std::map<std::int64_t, std::size_t> index_of;
  std::size_t malformed = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!times[i]) {
      ++malformed;
      continue;
    }
    images.push_back({*times[i], ImagePath(folder / "image_0", i, ending)});
    index_of.emplace(*times[i], i);
  }
  const std::string where = (folder / "times.txt").string();
  if (malformed > 0)
    dataset.warnings.push_back(where + ": " + std::to_string(malformed) + " malformed rows were skipped");
  for (const StampedFile& image : KeepAscending(std::move(images), where, dataset.warnings)) {
    const std::size_t i = index_of.at(image.stamp_ns);
    dataset.frames.push_back({image.stamp_ns, ImagePath(folder / "image_0", i, ending),
                              stereo ? ImagePath(folder / "image_1", i, ending) : fs::path()});
    if (i < poses.size() && poses[i]) dataset.ground_truth.push_back({image.stamp_ns, *poses[i]});
  }
  if (!poses.empty() && poses.size() != times.size()) {
    dataset.warnings.push_back((folder / "poses.txt").string() + ": " + std::to_string(poses.size()) + " poses for " +
                               std::to_string(times.size()) + " times");
  }
}

}  // namespace

bool IsKittiDataset(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / "times.txt", error) && fs::is_directory(folder / "image_0", error);
}

Result<Dataset> OpenKittiDataset(const fs::path& folder, SensorKind kind, const fs::path& calibration,
                                 GroundTruth truth) {
  Dataset dataset;
  dataset.name = folder.filename().string();
  dataset.layout = "KITTI";
  const auto times = ReadTimes(folder / "times.txt");
  if (!times) return tl::make_unexpected(times.error());
  const auto poses = truth == GroundTruth::kRead ? ReadPoses(folder / "poses.txt") : Poses();
  ListFrames(folder, kind, *times, poses, dataset);
  const auto size = FindImageSize(dataset.frames);
  if (!size) return tl::make_unexpected(size.error());
  auto rig = calibration.empty() ? ReadRig(folder, *size, kind) : ReadCameraChain(calibration, kind);
  if (!rig) return tl::make_unexpected(rig.error());
  dataset.rig = std::move(*rig);
  return dataset;
}

}  // namespace pangaea
