#include "cli/posed_recording.h"

#include <cmath>
#include <memory>
#include <utility>

#include "common/evaluation/absolute_error.h"
#include "common/evaluation/trajectory_file.h"
#include "common/features/orb_extractor.h"
#include "common/features/stereo_matcher.h"
#include "common/sensor/dataset.h"
#include "common/sensor/frame_reader.h"

namespace pangaea {
namespace {

constexpr double kNanoseconds = 1e9;

// Frames that are skipped for one reason; the first says why.
struct Skipped {
  std::size_t count = 0;
  std::string first;

  void Add(const std::string& why) {
    if (count++ == 0) first = why;
  }
  void WarnOf(const char* what, std::vector<std::string>& warnings) const {
    if (count > 0) warnings.push_back(std::to_string(count) + what + first);
  }
};

Result<std::pair<Dataset, SensorKind>> Open(const PosedRecordingOptions& options) {
  if (options.sensor) {
    auto dataset = OpenDataset(options.dataset, *options.sensor);
    if (!dataset) return tl::make_unexpected(dataset.error());
    return std::pair(std::move(*dataset), *options.sensor);
  }
  auto stereo = OpenDataset(options.dataset, SensorKind::kStereo);
  if (stereo) return std::pair(std::move(*stereo), SensorKind::kStereo);
  auto mono = OpenDataset(options.dataset, SensorKind::kMonocular);
  if (!mono) return tl::make_unexpected(mono.error());
  return std::pair(std::move(*mono), SensorKind::kMonocular);
}

Result<std::vector<StampedPose>> PosesOf(const PosedRecordingOptions& options, Dataset& dataset) {
  auto poses = options.poses.empty() ? Result<std::vector<StampedPose>>(std::move(dataset.ground_truth))
                                     : ReadTrajectory(options.poses);
  if (!poses || !poses->empty()) return poses;
  const std::string source = options.poses.empty() ? options.dataset.string() : options.poses.string();
  return Fail(ErrorCode::kNotFound, source + ": has no poses; give them with --poses FILE.tum");
}

// Turns images into what keyframes hold. One object per thread.
class KeyframeMaker {
 public:
  explicit KeyframeMaker(FrameReader reader) : reader_(std::move(reader)) {}

  const Rectifier& rectifier() const { return reader_.rectifier(); }
  const Skipped& unreadable() const { return unreadable_; }
  const Skipped& without_depth() const { return without_depth_; }

  // nullptr where the left image cannot be read.
  std::shared_ptr<const KeyframeData> Make(const DatasetFrame& frame) {
    const auto left = reader_.ReadLeft(frame);
    if (!left) {
      unreadable_.Add(left.error().message);
      return nullptr;
    }
    auto data = std::make_shared<KeyframeData>();
    data->stamp_ns = frame.stamp_ns;
    data->camera = rectifier().camera();
    data->features = extractor_.Extract(*left);
    if (data->camera.is_stereo()) MeasureDepth(frame, *left, *data);
    return data;
  }

 private:
  void MeasureDepth(const DatasetFrame& frame, const cv::Mat& left, KeyframeData& data) {
    const auto right = reader_.ReadRight(frame);
    if (right) {
      stereo_.Match(left, *right, data.camera, data.features.keypoints);
    } else {
      without_depth_.Add(right.error().message);
    }
  }

  FrameReader reader_;
  OrbExtractor extractor_;
  StereoMatcher stereo_;
  Skipped unreadable_;
  Skipped without_depth_;
};

void ReadKeyframes(const Dataset& dataset, const std::vector<StampedPose>& poses, double interval_s,
                   KeyframeMaker& maker, PosedRecording& recording) {
  Skipped without_pose;
  const double least_ns = interval_s * kNanoseconds;
  for (const DatasetFrame& frame : dataset.frames) {
    if (!recording.keyframes.empty() &&
        static_cast<double>(frame.stamp_ns - recording.keyframes.back().data->stamp_ns) < least_ns) {
      continue;
    }
    const auto world_from_body = InterpolatePose(poses, frame.stamp_ns, {});
    if (!world_from_body) {
      without_pose.Add(std::to_string(frame.stamp_ns));
      continue;
    }
    if (auto data = maker.Make(frame)) {
      recording.keyframes.push_back({std::move(data), *world_from_body * recording.body_from_camera});
    }
  }
  without_pose.WarnOf(" frames without a pose at their time were skipped, the first at ", recording.warnings);
  maker.unreadable().WarnOf(" frames were skipped: ", recording.warnings);
  maker.without_depth().WarnOf(" frames have no depth: ", recording.warnings);
}

}  // namespace

Result<PosedRecording> ReadPosedRecording(const PosedRecordingOptions& options) {
  if (!std::isfinite(options.interval_s) || options.interval_s < 0.0) {
    return Fail(ErrorCode::kInvalidArgument, "--interval: 0 or more seconds are allowed");
  }
  auto opened = Open(options);
  if (!opened) return tl::make_unexpected(opened.error());
  auto& [dataset, sensor] = *opened;
  const auto poses = PosesOf(options, dataset);
  if (!poses) return tl::make_unexpected(poses.error());
  auto reader = FrameReader::Create(dataset.rig, sensor);
  if (!reader) return tl::make_unexpected(reader.error());
  KeyframeMaker maker(std::move(*reader));
  PosedRecording recording{.name = dataset.name,
                           .sensor = sensor,
                           .camera = maker.rectifier().camera(),
                           .body_from_camera = maker.rectifier().body_from_camera(),
                           .keyframes = {},
                           .warnings = dataset.warnings};
  ReadKeyframes(dataset, *poses, options.interval_s, maker, recording);
  if (recording.keyframes.size() >= 2) return recording;
  std::string reason = recording.warnings.empty() ? "" : " (" + recording.warnings.back() + ")";
  return Fail(ErrorCode::kInvalidArgument, options.dataset.string() + ": a map needs two keyframes with poses, there " +
                                               (recording.keyframes.empty() ? "are none" : "is one") + reason);
}

}  // namespace pangaea
