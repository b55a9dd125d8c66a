#include "common/features/orb_extractor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "common/base/check.h"
#include "common/features/corner_detector.h"
#include "common/features/corner_refinement.h"
#include "common/features/corner_selection.h"
#include "common/features/orb_descriptor.h"
#include "common/features/scale_pyramid.h"

namespace pangaea {
namespace {

constexpr int kEdge = kDescribedRadius;  // new corners keep this far from the octave's edge: their patch is all image

// How many of `features` keypoints each octave should have: in proportion to its area.
std::array<double, kOctaves> OctaveShares(int features) {
  std::array<double, kOctaves> shares;
  double sum = 0.0;
  for (int o = 0; o < kOctaves; ++o) sum += shares[static_cast<std::size_t>(o)] = std::pow(kOctaveScale, -2.0 * o);
  for (double& share : shares) share *= features / sum;
  return shares;
}

int OctaveOf(const FixedPoint& point) { return std::clamp(point.octave, 0, kOctaves - 1); }

Keypoint MakeKeypoint(cv::Point2f pixel, int octave) {
  Keypoint keypoint;
  keypoint.u = QuantizePixel(pixel.x);
  keypoint.v = QuantizePixel(pixel.y);
  keypoint.octave = static_cast<std::uint8_t>(octave);
  return keypoint;
}

// How many new corners each octave should add: its share of all, less its fixed points, so that the sum is what is
// missing.
std::array<double, kOctaves> WantedByOctave(int features, std::span<const FixedPoint> fixed) {
  std::array<double, kOctaves> wanted = OctaveShares(features);
  for (const FixedPoint& point : fixed) wanted[static_cast<std::size_t>(OctaveOf(point))] -= 1.0;
  double sum = 0.0;
  for (double& count : wanted) sum += count = std::max(count, 0.0);
  const double missing = std::max(0.0, features - static_cast<double>(fixed.size()));
  for (double& count : wanted) count *= sum > 0.0 ? missing / sum : 0.0;
  return wanted;
}

// Adds corners to keypoints, each where it keeps its distance from what was added before.
class CornerCollector {
 public:
  CornerCollector(const OrbOptions& options, const ScalePyramid& pyramid, std::span<const FixedPoint> fixed,
                  std::vector<Keypoint>& keypoints)
      : options_(options),
        pyramid_(pyramid),
        keypoints_(keypoints),
        chosen_(pyramid.octave(0).size(), 2.0F * options.min_distance) {
    for (const FixedPoint& point : fixed) chosen_.Add({point.u, point.v}, kFixedTag);
  }

  // Takes candidates in their order until there are `limit` keypoints in all; returns those it did not come to.
  std::span<const Corner> Take(std::span<const Corner> candidates, int octave, std::size_t limit) {
    std::size_t seen = 0;
    for (; seen < candidates.size() && keypoints_.size() < limit; ++seen) {
      const cv::Point2f pixel = Refine(candidates[seen], octave);
      if (!IsFree(pixel, octave)) continue;
      chosen_.Add(pixel, octave);
      keypoints_.push_back(MakeKeypoint(pixel, octave));
    }
    return candidates.subspan(seen);
  }

 private:
  static constexpr int kFixedTag = -1;  // new corners have their octave as tag

  cv::Point2f Refine(const Corner& corner, int octave) const {
    const std::uint8_t* center = pyramid_.octave(octave).ptr<std::uint8_t>(corner.y) + corner.x;
    const cv::Point2f offset = RefineCorner(center, pyramid_.stride());
    return pyramid_.FromOctave(cv::Point2f(corner.x, corner.y) + offset, octave);
  }

  bool IsFree(cv::Point2f pixel, int octave) const {
    const auto scale = static_cast<float>(OctaveSigma(octave));
    const auto keeps_distance = [&](int tag) { return tag == kFixedTag || tag == octave; };
    return !chosen_.HasNeighbor(pixel, options_.min_distance * scale, keeps_distance) &&
           !chosen_.HasNeighbor(pixel, options_.same_corner_distance * scale, [](int) { return true; });
  }

  const OrbOptions& options_;
  const ScalePyramid& pyramid_;
  std::vector<Keypoint>& keypoints_;
  NeighborIndex chosen_;
};

}  // namespace

Status OrbOptions::Check() const {
  if (features < 1 || features > 100000) return Fail(ErrorCode::kInvalidArgument, "orb.features: allowed 1 to 100000");
  if (low_threshold < 1 || high_threshold < low_threshold || high_threshold > 254) {
    return Fail(ErrorCode::kInvalidArgument, "orb thresholds: allowed 1 <= low_threshold <= high_threshold <= 254");
  }
  if (!(min_distance >= 1.0F && min_distance <= 100.0F)) {
    return Fail(ErrorCode::kInvalidArgument, "orb.min_distance: allowed 1 to 100 pixels");
  }
  if (!(same_corner_distance >= 0.0F && same_corner_distance <= 100.0F)) {
    return Fail(ErrorCode::kInvalidArgument, "orb.same_corner_distance: allowed 0 to 100 pixels");
  }
  return {};
}

struct OrbExtractor::Workspace {
  ScalePyramid pyramid;
  CornerDetector detector;
  std::vector<Corner> corners;
  std::array<cv::Mat, kOctaves> smoothed_buffers;
  std::optional<RotatedBrief> brief;

  void AddNewCorners(const OrbOptions& options, std::span<const FixedPoint> fixed, std::vector<Keypoint>& keypoints);
  std::vector<Corner> CandidatesOfOctave(const OrbOptions& options, int octave, int wanted,
                                         std::span<const FixedPoint> fixed);
  void Describe(Features& features);
  cv::Mat Smooth(int octave);  // a view without the margin, of the pyramid's stride
};

OrbExtractor::OrbExtractor(OrbOptions options) : options_(options), workspace_(std::make_unique<Workspace>()) {
  PANGAEA_CHECK(options_.Check().has_value());
}
OrbExtractor::~OrbExtractor() = default;
OrbExtractor::OrbExtractor(OrbExtractor&&) noexcept = default;
OrbExtractor& OrbExtractor::operator=(OrbExtractor&&) noexcept = default;

Features OrbExtractor::Extract(const cv::Mat& image, std::span<const FixedPoint> fixed) {
  workspace_->pyramid.Build(image);
  Features features;
  features.keypoints.reserve(std::max(fixed.size(), static_cast<std::size_t>(options_.features)));
  for (const FixedPoint& point : fixed) {
    features.keypoints.push_back(MakeKeypoint({point.u, point.v}, OctaveOf(point)));
  }
  workspace_->AddNewCorners(options_, fixed, features.keypoints);
  workspace_->Describe(features);
  return features;
}

std::vector<Corner> OrbExtractor::Workspace::CandidatesOfOctave(const OrbOptions& options, int octave, int wanted,
                                                                std::span<const FixedPoint> fixed) {
  std::vector<cv::Point2f> occupied;
  for (const FixedPoint& point : fixed) {
    if (OctaveOf(point) == octave) occupied.push_back(pyramid.ToOctave({point.u, point.v}, octave));
  }
  const cv::Mat& image = pyramid.octave(octave);
  detector.Detect(image, options.low_threshold, kEdge, corners);
  return OrderBySpread(corners, image.size(), wanted, options.high_threshold, occupied);
}

// Each octave fills its share; what it cannot fill goes to the next, and in the end to whichever has more.
void OrbExtractor::Workspace::AddNewCorners(const OrbOptions& options, std::span<const FixedPoint> fixed,
                                            std::vector<Keypoint>& keypoints) {
  if (fixed.size() >= static_cast<std::size_t>(options.features)) return;
  const std::array<double, kOctaves> wanted = WantedByOctave(options.features, fixed);
  CornerCollector collector(options, pyramid, fixed, keypoints);
  std::array<std::vector<Corner>, kOctaves> candidates;
  std::array<std::span<const Corner>, kOctaves> left;
  double due = static_cast<double>(fixed.size());
  for (std::size_t o = 0; o < candidates.size(); ++o) {
    const int octave = static_cast<int>(o);
    due += wanted[o];
    candidates[o] = CandidatesOfOctave(options, octave, static_cast<int>(std::ceil(wanted[o])), fixed);
    left[o] = collector.Take(candidates[o], octave, static_cast<std::size_t>(std::lround(due)));
  }
  for (std::size_t o = 0; o < candidates.size(); ++o) {
    collector.Take(left[o], static_cast<int>(o), static_cast<std::size_t>(options.features));
  }
}

void OrbExtractor::Workspace::Describe(Features& features) {
  if (!brief || brief->stride() != pyramid.stride()) brief.emplace(pyramid.stride());
  std::array<cv::Mat, kOctaves> smoothed;  // views without the margin
  for (int o = 0; o < kOctaves; ++o) smoothed[static_cast<std::size_t>(o)] = Smooth(o);
  features.descriptors.reserve(features.keypoints.size());
  for (Keypoint& keypoint : features.keypoints) {
    const cv::Mat& image = smoothed[keypoint.octave];
    const cv::Point2f pixel = pyramid.ToOctave({keypoint.u, keypoint.v}, keypoint.octave);
    const int x = std::clamp(static_cast<int>(std::lround(pixel.x)), 0, image.cols - 1);
    const int y = std::clamp(static_cast<int>(std::lround(pixel.y)), 0, image.rows - 1);
    const std::uint8_t* center = image.ptr<std::uint8_t>(y) + x;
    keypoint.angle = PatchAngle(center, pyramid.stride());
    features.descriptors.push_back(brief->Describe(center, keypoint.angle));
  }
}

cv::Mat OrbExtractor::Workspace::Smooth(int octave) {
  const cv::Mat& padded = pyramid.padded(octave);
  cv::Mat& buffer = smoothed_buffers[static_cast<std::size_t>(octave)];
  buffer.create(padded.rows, pyramid.stride(), CV_8UC1);
  cv::Mat smoothed = buffer(cv::Rect({0, 0}, padded.size()));
  SmoothForBrief(padded, smoothed);
  return smoothed(cv::Rect({ScalePyramid::kMargin, ScalePyramid::kMargin}, pyramid.octave(octave).size()));
}

}  // namespace pangaea
