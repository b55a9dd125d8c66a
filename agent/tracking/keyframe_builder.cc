#include "agent/tracking/keyframe_builder.h"

namespace pangaea {

void TakeTracked(const LocatedFrame& located, const LocalMap& local_map, RawKeyframe& keyframe) {
  keyframe.tracked.clear();
  keyframe.landmarks.clear();
  keyframe.depths.clear();
  for (const LandmarkMatch& match : located.matches) {
    const LocalLandmark& landmark = local_map.landmarks[static_cast<std::size_t>(match.landmark)];
    keyframe.tracked.push_back(
        {static_cast<float>(match.pixel.x()), static_cast<float>(match.pixel.y()), match.octave});
    keyframe.landmarks.push_back(landmark.id);
    keyframe.depths.push_back(static_cast<float>((located.pose.camera_from_map * landmark.point_in_map).z()));
  }
}

KeyframeBuilder::KeyframeBuilder(const IdealCamera& camera, const OrbOptions& orb, const StereoOptions& stereo)
    : camera_(camera), extractor_(orb), stereo_(stereo) {}

KeyframeCandidate KeyframeBuilder::Build(const RawKeyframe& keyframe, StageRecorder& stages) {
  const auto data =
      Describe(keyframe.stamp_ns, keyframe.left, keyframe.right, keyframe.tracked, keyframe.depths, stages);
  data->arrival = keyframe.arrival;
  KeyframeCandidate candidate;
  candidate.id = keyframe.id;
  candidate.map = keyframe.map;
  candidate.reference = keyframe.reference;
  candidate.camera_from_reference = keyframe.camera_from_reference;
  candidate.reference_scale = keyframe.reference_scale;
  candidate.landmarks = keyframe.landmarks;
  candidate.landmarks.resize(data->features.keypoints.size());
  candidate.data = data;
  return candidate;
}

std::shared_ptr<KeyframeData> KeyframeBuilder::Describe(std::int64_t stamp_ns, const cv::Mat& left,
                                                        const RightImage& right, std::span<const FixedPoint> fixed,
                                                        std::span<const float> depths, StageRecorder& stages) {
  auto data = std::make_shared<KeyframeData>();
  data->stamp_ns = stamp_ns;
  data->camera = camera_;
  {
    const StageScope scope(stages, "keyframe.extract");
    data->features = extractor_.Extract(left, fixed);
  }
  if (!camera_.is_stereo() || !right) return data;
  const StageScope scope(stages, "keyframe.stereo");
  const cv::Mat image = right(stages);
  if (image.empty()) return data;
  std::vector<float> predicted(depths.begin(), depths.end());
  predicted.resize(data->features.keypoints.size(), 0.0F);  // unknown
  stereo_.Match(left, image, camera_, data->features.keypoints, predicted);
  return data;
}

}  // namespace pangaea
