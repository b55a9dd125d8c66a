#include "cli/truth.h"

#include <filesystem>
#include <utility>

#include "common/evaluation/trajectory_file.h"
#include "common/sensor/dataset.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;

// What is kept of the ground truth before the first and after the last frame, to interpolate.
constexpr std::int64_t kTruthMargin_ns = 200'000'000;

struct NamedPath {
  std::string name;  // empty: not given
  fs::path path;
};

NamedPath Parse(const std::string& argument) {
  const std::size_t equals = argument.find('=');
  std::error_code error;
  if (equals == std::string::npos || fs::exists(argument, error)) return {{}, argument};
  return {argument.substr(0, equals), argument.substr(equals + 1)};
}

Result<Truth> ReadFile(const fs::path& path) {
  auto poses = ReadTrajectory(path);
  if (!poses) return tl::make_unexpected(poses.error());
  if (poses->empty()) return Fail(ErrorCode::kCorrupt, path.string() + ": holds no poses");
  return Truth{.name = path.stem().string(), .source = path.string(), .poses = std::move(*poses)};
}

Result<Truth> ReadDataset(const fs::path& folder) {
  // Only stereo counts the frames that a stereo agent sees; a recording with one camera opens as a monocular one.
  auto dataset = OpenDataset(folder, SensorKind::kStereo);
  if (!dataset) dataset = OpenDataset(folder, SensorKind::kMonocular);
  if (!dataset) return tl::make_unexpected(dataset.error());
  Truth truth{.name = dataset->name, .source = folder.string(), .poses = std::move(dataset->ground_truth)};
  truth.frames = dataset->frames.size();
  // Many recordings are cut from a longer one, and come with the truth of all of it.
  std::erase_if(truth.poses, [&](const StampedPose& pose) {
    return pose.stamp_ns < dataset->frames.front().stamp_ns - kTruthMargin_ns ||
           pose.stamp_ns > dataset->frames.back().stamp_ns + kTruthMargin_ns;
  });
  truth.body_from_camera = dataset->rig.body_from_left;
  if (dataset->layout == "KITTI") {
    // Its world is the first camera of the sequence, y pointing down.
    truth.up = {0.0, -1.0, 0.0};
    truth.shares_world = false;
  }
  return truth;
}

}  // namespace

Result<Truth> ReadTruth(const std::string& argument) {
  const NamedPath named = Parse(argument);
  std::error_code error;
  auto truth = fs::is_regular_file(named.path, error) ? ReadFile(named.path) : ReadDataset(named.path);
  if (truth && !named.name.empty()) truth->name = named.name;
  return truth;
}

Result<std::vector<Truth>> ReadTruths(const std::vector<std::string>& arguments) {
  std::vector<Truth> truths;
  for (const std::string& argument : arguments) {
    auto truth = ReadTruth(argument);
    if (!truth) return tl::make_unexpected(truth.error());
    truths.push_back(std::move(*truth));
  }
  return truths;
}

}  // namespace pangaea
