#include "common/features/stereo_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/check.h"
#include "common/features/patch_pyramid.h"
#include "common/features/row_alignment.h"
#include "common/features/row_search.h"

namespace pangaea {
namespace {

constexpr int kLevels = 2;  // of halving: the coarsest octave is reduced by 3.6

// The coarsest level that shows all the octave does: a level between would lose accuracy.
int LevelOf(int octave) {
  return std::clamp(static_cast<int>(std::floor(std::log2(OctaveSigma(octave)))), 0, kLevels - 1);
}

struct DisparityRange {
  double least = 0.0;
  double most = 0.0;
};

DisparityRange SearchRange(const StereoOptions& options, const IdealCamera& camera, float predicted_depth) {
  const double most = camera.focal_x / options.min_depth_baselines;
  if (!(predicted_depth > 0.0F)) return {0.0, most};
  const double predicted = std::min(camera.focal_x * camera.baseline / static_cast<double>(predicted_depth), most);
  const double margin = options.predicted_share * predicted + options.predicted_margin;
  return {std::max(0.0, predicted - margin), std::min(most, predicted + margin)};
}

Status CheckRange(const char* name, double value, double least, double most) {
  if (value >= least && value <= most) return {};
  return Fail(ErrorCode::kInvalidArgument,
              std::string("stereo.") + name + ": allowed " + std::to_string(least) + " to " + std::to_string(most));
}

}  // namespace

Status StereoOptions::Check() const {
  return CheckRange("min_depth_baselines", min_depth_baselines, 0.5, 1000.0)
      .and_then([&] { return CheckRange("min_disparity", min_disparity, 0.03125, 100.0); })
      .and_then([&] { return CheckRange("predicted_share", predicted_share, 0.0, 10.0); })
      .and_then([&] { return CheckRange("predicted_margin", predicted_margin, 1.0, 1000.0); })
      .and_then([&] { return CheckRange("row_tolerance", row_tolerance, 0.0, 8.0); })
      .and_then([&] { return CheckRange("min_texture", min_texture, 0.0, 100.0); })
      .and_then([&] { return CheckRange("uniqueness", uniqueness, 0.0, 1.0); })
      .and_then([&] { return CheckRange("max_difference", max_difference, 0.0, 10.0); })
      .and_then([&] { return CheckRange("consistency", consistency, 0.0, 100.0); })
      .and_then([&] { return CheckRange("min_correlation", min_correlation, 0.0, 1.0); });
}

struct StereoMatcher::Workspace {
  enum class Outcome { kMatched, kNoTexture, kAmbiguous, kInconsistent, kNotAligned, kOutOfRange };

  ImagePyramid left, right;
  std::array<RowGradient, kLevels> left_gradients, right_gradients;
  RowSearch search;

  void Build(const cv::Mat& left_image, const cv::Mat& right_image) {
    BuildImagePyramid(left_image, kLevels, left);
    BuildImagePyramid(right_image, kLevels, right);
    for (std::size_t l = 0; l < kLevels; ++l) {
      left_gradients[l].Build(left.levels[l]);
      right_gradients[l].Build(right.levels[l]);
    }
  }
  Outcome MatchOne(const StereoOptions& options, DisparityRange range, Keypoint& keypoint);
};

StereoMatcher::StereoMatcher(StereoOptions options) : options_(options), workspace_(std::make_unique<Workspace>()) {
  PANGAEA_CHECK(options_.Check().has_value());
}
StereoMatcher::~StereoMatcher() = default;
StereoMatcher::StereoMatcher(StereoMatcher&&) noexcept = default;
StereoMatcher& StereoMatcher::operator=(StereoMatcher&&) noexcept = default;

StereoStatistics StereoMatcher::Match(const cv::Mat& left, const cv::Mat& right, const IdealCamera& camera,
                                      std::span<Keypoint> keypoints, std::span<const float> predicted_depth) {
  PANGAEA_CHECK(camera.is_stereo() && left.size() == right.size());
  PANGAEA_CHECK(left.cols == camera.width && left.rows == camera.height);
  PANGAEA_CHECK(predicted_depth.empty() || predicted_depth.size() == keypoints.size());
  workspace_->Build(left, right);
  StereoStatistics statistics;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const float depth = predicted_depth.empty() ? 0.0F : predicted_depth[i];
    keypoints[i].u_right = -1.0F;
    switch (workspace_->MatchOne(options_, SearchRange(options_, camera, depth), keypoints[i])) {
      case Workspace::Outcome::kMatched:
        ++statistics.matched;
        break;
      case Workspace::Outcome::kNoTexture:
        ++statistics.no_texture;
        break;
      case Workspace::Outcome::kAmbiguous:
        ++statistics.ambiguous;
        break;
      case Workspace::Outcome::kInconsistent:
        ++statistics.inconsistent;
        break;
      case Workspace::Outcome::kNotAligned:
        ++statistics.not_aligned;
        break;
      case Workspace::Outcome::kOutOfRange:
        ++statistics.out_of_range;
        break;
    }
  }
  return statistics;
}

StereoMatcher::Workspace::Outcome StereoMatcher::Workspace::MatchOne(const StereoOptions& options, DisparityRange range,
                                                                     Keypoint& keypoint) {
  const int level = LevelOf(keypoint.octave);
  const auto l = static_cast<std::size_t>(level);
  const auto scale = static_cast<float>(1 << level);
  const cv::Point2f pixel(keypoint.u / scale, keypoint.v / scale);
  const int x = static_cast<int>(std::lround(pixel.x)), y = static_cast<int>(std::lround(pixel.y));
  const RowGradient& left_gradient = left_gradients[l];
  const RowGradient& right_gradient = right_gradients[l];
  if (!GradientBlock::Fits(left_gradient, x, y)) return Outcome::kOutOfRange;

  const GradientBlock block = GradientBlock::At(left_gradient, x, y);
  if (block.Texture() < options.min_texture) return Outcome::kNoTexture;
  const int least = static_cast<int>(std::floor(range.least / scale));
  const int most = static_cast<int>(std::ceil(range.most / scale));
  auto there = search.Find(block, right_gradient, x - most, x - least, y, 0);
  if (!there) return Outcome::kOutOfRange;
  if (there->cost >= options.uniqueness * there->second_cost) return Outcome::kAmbiguous;
  if (there->cost > options.max_difference * block.Texture() * GradientBlock::kUnits) return Outcome::kAmbiguous;
  // The row itself finds the place; the rows around it may show it better.
  constexpr int kColumnsAround = 2;
  there = search.Find(block, right_gradient, there->x - kColumnsAround, there->x + kColumnsAround, y,
                      options.row_tolerance);

  const GradientBlock found = GradientBlock::At(right_gradient, there->x, there->y);
  const auto back = search.Find(found, left_gradient, there->x + least, there->x + most, y, 0);
  if (!back || std::abs(back->x - x) > options.consistency) return Outcome::kInconsistent;

  const cv::Point2f start = pixel + cv::Point2f(static_cast<float>(there->x - x), static_cast<float>(there->y - y));
  const auto aligned = AlignAlongRow(left.levels[l], pixel, right.levels[l], start);
  if (!aligned || aligned->correlation < options.min_correlation) return Outcome::kNotAligned;
  const float u_right = QuantizePixel(aligned->position.x * scale);
  if (keypoint.u - u_right < static_cast<float>(options.min_disparity) || u_right < 0.0F) return Outcome::kOutOfRange;
  keypoint.u_right = u_right;
  return Outcome::kMatched;
}

}  // namespace pangaea
