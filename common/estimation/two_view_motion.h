#pragma once

#include <cstdint>
#include <span>
#include <tl/expected.hpp>
#include <vector>

#include "common/base/result.h"
#include "common/estimation/two_view_models.h"

namespace pangaea {

struct TwoViewOptions {
  TwoViewRansacOptions ransac{};
  // S_H / (S_H + S_F) above which the homography is taken (Mur-Artal, Montiel and Tardos 2015, section IV): a plane or
  // little parallax, where an essential matrix is ill-determined. They take 0.45; with noise as assumed, a plane gives
  // 0.453 on average, so that a little less is safer.
  double homography_ratio = 0.42;
  // Degrees between the two rays of a point: below it its depth is noise, and it is left out.
  double min_parallax = 1.0;
  // A reconstruction needs so many points with that parallax (count), and this share of the matches.
  int min_points = 80;
  double min_point_share = 0.35;
  // Of the motions that a model leaves possible the second best may explain at most this share of the best one's
  // points: otherwise it is not clear which one is true.
  double max_runner_up = 0.75;
  // So many matches beside the plane of a homography (count), and this share of all, decide which of its motions is the
  // true one. Noise alone leaves up to 6 % beside it.
  int min_beside_plane = 20;
  double min_beside_plane_share = 0.06;
  // Steps of bundle adjustment over both views, with the robust kernel and then without it and without outliers: the
  // optimum of least squares is reached to the last digit, from whatever sample of matches.
  int iterations = 10;
  int iterations_without_outliers = 10;

  // Says which option is out of which range.
  Status Check() const;
};

// A match that became a point.
struct TwoViewPoint {
  std::uint32_t match = 0;  // index into the matches
  Eigen::Vector3d point_in_first;
};

struct TwoViewReconstruction {
  Rigid3d second_from_first;
  std::vector<TwoViewPoint> points;  // ascending by match; inliers of both views, in front of both
  double median_parallax = 0.0;      // of the points, degrees
  bool planar = false;               // the homography explains nearly all
};

// Why there is no reconstruction (yet).
enum class TwoViewRefusal {
  kTooFewMatches,
  kNoModel,      // neither model explains enough of the matches
  kLowParallax,  // the camera hardly moved, or only turned
  kAmbiguous,    // two motions explain the matches about equally well
};

const char* ToString(TwoViewRefusal refusal);

// Motion and structure from two views of one camera without any first guess: homography and essential matrix compete,
// the better one's motions are tried, the winner is adjusted on both views. Matches beside a plane help to choose among
// the motions that it leaves possible. The scale is such that the median depth of the points in the first camera is 1.
// The same seed gives the same answer, and mostly any seed does: the answer is the optimum that the motion found first
// leads to, rounded to a hundredth of a pixel.
tl::expected<TwoViewReconstruction, TwoViewRefusal> ReconstructFromTwoViews(const IdealCamera& camera,
                                                                            std::span<const PixelMatch> matches,
                                                                            const TwoViewOptions& options,
                                                                            std::uint64_t seed);

}  // namespace pangaea
