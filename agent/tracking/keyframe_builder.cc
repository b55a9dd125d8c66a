#include "agent/tracking/keyframe_builder.h"

namespace pangaea {
namespace {

std::vector<FixedPoint> FixedPointsOf(std::span<const LandmarkMatch> matches) {
  std::vector<FixedPoint> fixed;
  fixed.reserve(matches.size());
  for (const LandmarkMatch& match : matches) {
    fixed.push_back({static_cast<float>(match.pixel.x()), static_cast<float>(match.pixel.y()), match.octave});
  }
  return fixed;
}

// The depths that the map predicts for the first keypoints; unknown for the others.
std::vector<float> PredictDepths(const LocatedFrame& located, const LocalMap& local_map, std::size_t keypoints) {
  std::vector<float> depths(keypoints, 0.0F);
  for (std::size_t i = 0; i < located.matches.size(); ++i) {
    const Eigen::Vector3d& point = local_map.landmarks[located.matches[i].landmark].point_in_map;
    depths[i] = static_cast<float>((located.pose.camera_from_map * point).z());
  }
  return depths;
}

}  // namespace

KeyframeBuilder::KeyframeBuilder(const IdealCamera& camera, const OrbOptions& orb, const StereoOptions& stereo)
    : camera_(camera), extractor_(orb), stereo_(stereo) {}

BuiltKeyframe KeyframeBuilder::Build(std::int64_t stamp_ns, const cv::Mat& left, const RightImage& right,
                                     const LocatedFrame* located, const LocalMap& local_map, StageRecorder& stages) {
  const auto fixed = located != nullptr ? FixedPointsOf(located->matches) : std::vector<FixedPoint>{};
  const auto data = Describe(stamp_ns, left, fixed, stages);
  BuiltKeyframe built;
  built.landmarks.resize(data->features.keypoints.size());
  std::vector<float> depths;
  if (located != nullptr) {
    for (std::size_t i = 0; i < located->matches.size(); ++i) {
      built.landmarks[i] = local_map.landmarks[located->matches[i].landmark].id;
    }
    depths = PredictDepths(*located, local_map, data->features.keypoints.size());
  }
  if (camera_.is_stereo()) {
    StageScope scope(stages, "tracking.stereo");
    const cv::Mat image = right();
    if (!image.empty())
      built.keypoints_with_depth = stereo_.Match(left, image, camera_, data->features.keypoints, depths).matched;
  }
  built.data = data;
  return built;
}

std::shared_ptr<KeyframeData> KeyframeBuilder::Describe(std::int64_t stamp_ns, const cv::Mat& left,
                                                        std::span<const FixedPoint> fixed, StageRecorder& stages) {
  StageScope scope(stages, "tracking.extract");
  auto data = std::make_shared<KeyframeData>();
  data->stamp_ns = stamp_ns;
  data->camera = camera_;
  data->features = extractor_.Extract(left, fixed);
  return data;
}

}  // namespace pangaea
