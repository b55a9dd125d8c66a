#include "common/evaluation/trajectory_file.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "common/base/text.h"

namespace pangaea {
namespace {

constexpr std::size_t kFields = 8;
constexpr double kUnitTolerance = 0.1;  // a quaternion this far from length one is not a rounded one

std::optional<StampedPose> ParsePose(std::string_view line) {
  const auto fields = SplitFields(line, ' ');
  if (fields.size() != kFields) return std::nullopt;
  const auto stamp = ParseSeconds(fields[0]);
  std::array<double, kFields - 1> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto number = ParseNumber(fields[i + 1]);
    if (!number) return std::nullopt;
    numbers[i] = *number;
  }
  const Eigen::Quaterniond rotation(numbers[6], numbers[3], numbers[4], numbers[5]);
  if (!stamp || std::abs(rotation.norm() - 1.0) > kUnitTolerance) return std::nullopt;
  return StampedPose{*stamp, Rigid3d(rotation, {numbers[0], numbers[1], numbers[2]})};
}

}  // namespace

std::string FormatTrajectory(std::span<const StampedPose> poses) {
  std::string text;
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d& t = pose.world_from_body.translation();
    const Eigen::Quaterniond& q = pose.world_from_body.rotation();
    char numbers[256];
    std::snprintf(numbers, sizeof(numbers), " %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", t.x(), t.y(), t.z(), q.x(), q.y(),
                  q.z(), q.w());
    text += FormatSeconds(pose.stamp_ns) + numbers;
  }
  return text;
}

Status WriteTrajectory(const std::filesystem::path& path, std::span<const StampedPose> poses) {
  return WriteTextFile(path, FormatTrajectory(poses));
}

Result<std::vector<StampedPose>> ParseTrajectory(const std::string& text, const std::string& name) {
  std::vector<StampedPose> poses;
  int wrong_line = 0;
  ForEachLine(text, [&](int number, std::string_view line) {
    if (line.empty() || line.front() == '#' || wrong_line != 0) return;
    const auto pose = ParsePose(line);
    if (pose) {
      poses.push_back(*pose);
    } else {
      wrong_line = number;
    }
  });
  if (wrong_line == 0) return poses;
  return Fail(ErrorCode::kCorrupt, name + ":" + std::to_string(wrong_line) +
                                       ": not a pose; expected: seconds tx ty tz qx qy qz qw, with a unit quaternion");
}

Result<std::vector<StampedPose>> ReadTrajectory(const std::filesystem::path& path) {
  const auto text = ReadTextFile(path);
  if (!text) return tl::make_unexpected(text.error());
  return ParseTrajectory(*text, path.string());
}

}  // namespace pangaea
