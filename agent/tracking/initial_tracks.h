#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "agent/tracking/patch_alignment.h"
#include "agent/tracking/patch_template.h"
#include "agent/tracking/sparse_alignment.h"
#include "common/features/patch_pyramid.h"
#include "common/geometry/keypoint.h"

namespace pangaea {

// Where a keypoint of the first image is seen in a later one.
struct InitialTrack {
  std::uint32_t keypoint = 0;  // of the first image
  Eigen::Vector2f pixel;       // full resolution
  float sigma = 1.0F;          // pixels
};

// Follows keypoints of one image through the images after it, without a map. Every image is compared with the first
// one, so that errors do not add up. One owner thread.
class InitialTracks {
 public:
  struct Options {
    PatchAlignmentOptions alignment;
    SparseAlignmentOptions prediction;
    double patch_sigma = 0.5;  // pixels of a patch's pyramid level
  };

  // `image` is kept as its pixels are: they must not change.
  InitialTracks(const IdealCamera& camera, const Options& options, const ImagePyramid& image,
                std::span<const Keypoint> keypoints);

  // Looks for the tracks in the next image; those that are not found end.
  void Follow(const ImagePyramid& image);

  const ImagePyramid& first_image() const { return first_image_; }
  std::span<const InitialTrack> tracks() const { return tracks_; }  // ascending by keypoint
  std::size_t begun() const { return begun_; }
  // Median way in the image since the first one, pixels; 0 without tracks.
  double MedianFlow() const;

 private:
  float SigmaAt(int level) const;
  std::optional<Eigen::Vector2d> FollowCoarsely(const ImagePyramid& image, const Eigen::Vector2d& latest_pixel,
                                                const Eigen::Vector2d& predicted) const;
  Rigid3d PredictMotion(const ImagePyramid& image) const;

  IdealCamera camera_;
  Options options_;
  ImagePyramid first_image_;
  ImagePyramid latest_image_;
  std::vector<PatchTemplate> templates_;  // index by index with tracks_
  std::vector<InitialTrack> tracks_;
  std::size_t begun_ = 0;
  // As if everything were at depth 1: what it predicts of the image's motion is good enough.
  Rigid3d latest_from_first_;
};

}  // namespace pangaea
