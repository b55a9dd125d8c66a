#include "tests/place/surveyed_recording.h"

#include <algorithm>
#include <cstdlib>

#include "common/features/orb_extractor.h"
#include "common/features/stereo_matcher.h"
#include "common/sensor/dataset.h"
#include "common/sensor/frame_reader.h"

namespace pangaea::testing {

Result<std::vector<SurveyedKeyframe>> ReadSurveyedKeyframes(const std::filesystem::path& folder, int features) {
  const auto dataset = OpenDataset(folder, SensorKind::kStereo);
  if (!dataset) return tl::make_unexpected(dataset.error());
  const auto reader = FrameReader::Create(dataset->rig, SensorKind::kStereo);
  if (!reader) return tl::make_unexpected(reader.error());
  if (dataset->ground_truth.empty()) return Fail(ErrorCode::kNotFound, folder.string() + ": no ground truth");
  OrbExtractor extractor(OrbOptions{.features = features});
  StereoMatcher matcher;
  const Rectifier& rectifier = reader->rectifier();
  std::vector<SurveyedKeyframe> keyframes;
  for (const DatasetFrame& frame : dataset->frames) {
    const auto left = reader->ReadLeft(frame), right = reader->ReadRight(frame);
    if (!left) return tl::make_unexpected(left.error());
    if (!right) return tl::make_unexpected(right.error());
    const auto truth = std::ranges::min_element(
        dataset->ground_truth, {}, [&](const StampedPose& pose) { return std::abs(pose.stamp_ns - frame.stamp_ns); });
    SurveyedKeyframe keyframe{extractor.Extract(*left), rectifier.camera(),
                              truth->world_from_body * rectifier.body_from_camera(), truth->world_from_body};
    matcher.Match(*left, *right, keyframe.camera, keyframe.features.keypoints);
    keyframes.push_back(std::move(keyframe));
  }
  return keyframes;
}

}  // namespace pangaea::testing
