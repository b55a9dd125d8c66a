#include "agent/tracking/initial_tracks.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/base/median.h"

namespace pangaea {
namespace {

// Points that the motion between two images is predicted from: as many as tracking uses.
constexpr std::size_t kPredictionPoints = 300;
// Its patches are found on levels 2 and 3: up to 48 pixels from where they are expected.
constexpr int kCoarseOctave = 8;

}  // namespace

InitialTracks::InitialTracks(const IdealCamera& camera, const Options& options, const ImagePyramid& image,
                             std::span<const Keypoint> keypoints)
    : camera_(camera), options_(options), first_image_(CopyPyramid(image)), latest_image_(first_image_) {
  for (std::uint32_t i = 0; i < keypoints.size(); ++i) {
    const Eigen::Vector2f pixel(keypoints[i].u, keypoints[i].v);
    const auto patch = CutTemplate(image, KeyframeId{}, pixel.cast<double>(), keypoints[i].octave);
    if (!patch) continue;
    templates_.push_back(*patch);
    tracks_.push_back({i, pixel, SigmaAt(patch->level)});
  }
  begun_ = tracks_.size();
}

void InitialTracks::Follow(const ImagePyramid& image) {
  const Rigid3d image_from_latest = PredictMotion(image);
  latest_from_first_ = image_from_latest * latest_from_first_;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const Eigen::Vector3d predicted = image_from_latest * camera_.Unproject(tracks_[i].pixel.cast<double>());
    const auto affine = CurrentFromTemplate(camera_, latest_from_first_, camera_.Unproject(templates_[i].pixel));
    if (predicted.z() <= 0.0 || !affine) continue;
    const Eigen::Vector2d pixel = camera_.Project(predicted);
    auto aligned = AlignPatch(image, templates_[i], *affine, pixel, true, options_.alignment);
    if (!aligned) {
      const auto nearer = FollowCoarsely(image, tracks_[i].pixel.cast<double>(), pixel);
      if (nearer) aligned = AlignPatch(image, templates_[i], *affine, *nearer, true, options_.alignment);
    }
    if (!aligned) continue;
    if (kept != i) templates_[kept] = templates_[i];
    tracks_[kept] = {tracks_[i].keypoint, aligned->pixel.cast<float>(), SigmaAt(aligned->level)};
    ++kept;
  }
  templates_.resize(kept);
  tracks_.resize(kept);
  latest_image_ = CopyPyramid(image);
}

float InitialTracks::SigmaAt(int level) const { return static_cast<float>(std::ldexp(options_.patch_sigma, level)); }

// Near things move otherwise than the whole image does: finds by how much, on coarse levels, from the latest image.
std::optional<Eigen::Vector2d> InitialTracks::FollowCoarsely(const ImagePyramid& image,
                                                             const Eigen::Vector2d& latest_pixel,
                                                             const Eigen::Vector2d& predicted) const {
  const auto patch = CutTemplate(latest_image_, KeyframeId{}, latest_pixel, kCoarseOctave);
  if (!patch) return std::nullopt;
  const auto aligned = AlignPatch(image, *patch, Eigen::Matrix2d::Identity(), predicted, true, options_.alignment);
  if (!aligned) return std::nullopt;
  return aligned->pixel;
}

double InitialTracks::MedianFlow() const {
  std::vector<double> ways;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    ways.push_back((tracks_[i].pixel.cast<double>() - templates_[i].pixel).norm());
  }
  return Median(std::move(ways));
}

Rigid3d InitialTracks::PredictMotion(const ImagePyramid& image) const {
  std::vector<Eigen::Vector3d> points;
  const std::size_t stride = tracks_.size() / kPredictionPoints + 1;
  for (std::size_t i = 0; i < tracks_.size(); i += stride)
    points.push_back(camera_.Unproject(tracks_[i].pixel.cast<double>()));
  return AlignSparsely(latest_image_, image, camera_, points, Rigid3d(), options_.prediction).value_or(Rigid3d());
}

}  // namespace pangaea
