#include "common/sensor/recording_tables.h"

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "common/base/text.h"
#include "common/sensor/image.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPoseFields = 8;  // stamp, position, quaternion
constexpr double kUnitTolerance = 0.1;  // a quaternion this far from length one is not a rounded one

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

using Fields = std::vector<std::string_view>;

std::optional<std::int64_t> ParseStamp(std::string_view field, const TableFormat& format) {
  const auto stamp = format.stamps_in_seconds ? ParseSeconds(field) : ParseInteger(field);
  return stamp && *stamp >= 0 ? stamp : std::nullopt;
}

std::optional<StampedFile> ParseImage(const Fields& fields, const TableFormat& format, std::string_view prefix) {
  for (std::size_t i = 0; i + 1 < fields.size(); i += 2) {
    const std::string_view name = fields[i + 1];
    if (name.empty() || !name.starts_with(prefix)) continue;
    const auto stamp = ParseStamp(fields[i], format);
    return stamp ? std::optional(StampedFile{*stamp, std::string(name)}) : std::nullopt;
  }
  return std::nullopt;
}

std::optional<StampedPose> ParsePose(const Fields& fields, const TableFormat& format) {
  if (fields.size() < kPoseFields) return std::nullopt;
  const auto stamp = ParseStamp(fields[0], format);
  std::array<double, kPoseFields - 1> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto number = ParseNumber(fields[i + 1]);
    if (!number) return std::nullopt;
    numbers[i] = *number;
  }
  const auto& [x, y, z, a, b, c, d] = numbers;
  const Eigen::Quaterniond rotation =
      format.quaternion_scalar_first ? Eigen::Quaterniond(a, b, c, d) : Eigen::Quaterniond(d, a, b, c);
  if (!stamp || std::abs(rotation.norm() - 1.0) > kUnitTolerance) return std::nullopt;
  return StampedPose{*stamp, Rigid3d(rotation, {x, y, z})};
}

// `parse` makes an optional item of a row's fields.
template <typename T, typename Parse>
Result<std::vector<T>> ReadTable(const fs::path& file, const TableFormat& format, const Parse& parse,
                                 std::vector<std::string>& warnings) {
  const auto text = ReadTextFile(file);
  if (!text) return tl::make_unexpected(text.error());
  std::vector<T> items;
  MalformedRows malformed;
  ForEachLine(*text, [&](int number, std::string_view line) {
    if (line.empty() || line.front() == '#') return;
    auto item = parse(SplitFields(line, format.separator));
    if (!item) return malformed.Add(number);
    items.push_back(std::move(*item));
  });
  malformed.Warn(file, warnings);
  return KeepAscending(std::move(items), file.string(), warnings);
}

}  // namespace

Result<std::vector<StampedFile>> ReadImageTable(const fs::path& file, const TableFormat& format, const fs::path& folder,
                                                std::string_view prefix, std::vector<std::string>& warnings) {
  auto images = ReadTable<StampedFile>(
      file, format, [&](const Fields& fields) { return ParseImage(fields, format, prefix); }, warnings);
  if (!images) return images;
  if (images->empty()) return Fail(ErrorCode::kCorrupt, file.string() + ": lists no images");
  for (StampedFile& image : *images) image.path = (folder / image.path).string();
  return images;
}

Result<std::vector<StampedPose>> ReadPoseTable(const fs::path& file, const TableFormat& format,
                                               std::vector<std::string>& warnings) {
  return ReadTable<StampedPose>(
      file, format, [&](const Fields& fields) { return ParsePose(fields, format); }, warnings);
}

Status CheckImageSizes(const std::vector<StampedFile>& images, const LensModel& lens,
                       const fs::path& calibration_file) {
  const ImageSize calibrated{lens.width, lens.height};
  std::optional<ImageSize> other;
  for (const std::size_t i : {std::size_t{0}, images.size() / 2, images.size() - 1}) {
    const auto size = ReadImageSize(images[i].path);
    if (!size) continue;
    if (*size == calibrated) return {};
    other = *size;
  }
  if (!other) return {};
  return Fail(ErrorCode::kInvalidArgument,
              calibration_file.string() + ": resolution is [" + std::to_string(calibrated.width) + ", " +
                  std::to_string(calibrated.height) + "], but the images are " + std::to_string(other->width) + " x " +
                  std::to_string(other->height) + "; allowed: the size of the images");
}

}  // namespace pangaea
