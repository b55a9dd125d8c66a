#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/ideal_camera.h"
#include "common/geometry/rigid3.h"

namespace pangaea {

// One point seen in two images of one camera: ideal pixels.
struct PixelMatch {
  Eigen::Vector2d first;
  Eigen::Vector2d second;
  double inverse_sigma = 1.0;  // of each coordinate, 1 / pixels
};

// A model of what happened between two images, found by RANSAC.
struct TwoViewModel {
  Eigen::Matrix3d matrix;  // between points at z = 1: a homography second ~ H first, or E with second' E first = 0
  // How well it explains all matches, by symmetric transfer errors: S_H or S_F of Mur-Artal, Montiel and Tardos 2015,
  // section IV, in sigmas. 2 x 5.99 for a perfect match, 0 for an outlier.
  double score = 0.0;
  std::vector<std::uint8_t> inliers;  // per match, 0 or 1
};

struct TwoViewRansacOptions {
  int max_iterations = 300;  // five clean of two-to-one matches are found in fewer draws
  double confidence = 0.999;
  // With little parallax five matches, all of them right, may give a motion far from the true one.
  int min_iterations = 200;
};

// A plane, or a camera that only turned. The same seed gives the same answer.
std::optional<TwoViewModel> FindHomography(const IdealCamera& camera, std::span<const PixelMatch> matches,
                                           const TwoViewRansacOptions& options, std::uint64_t seed);
// A scene with depth, seen from two places.
std::optional<TwoViewModel> FindEssentialMatrix(const IdealCamera& camera, std::span<const PixelMatch> matches,
                                                const TwoViewRansacOptions& options, std::uint64_t seed);
// Per match, 1 where it is an inlier of the essential matrix of this motion, by the test of FindEssentialMatrix.
std::vector<std::uint8_t> EpipolarInliers(const IdealCamera& camera, std::span<const PixelMatch> matches,
                                          const Rigid3d& second_from_first);

}  // namespace pangaea
