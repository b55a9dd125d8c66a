#include "common/mapping/two_view_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/geometry/reprojection.h"
#include "common/geometry/triangulation.h"
#include "common/mapping/measurement_noise.h"

namespace pangaea {
namespace {

// Rows of the essential matrix (other^T E this = 0) in pixel coordinates.
Eigen::Matrix3d FundamentalMatrix(const Keyframe& keyframe, const Keyframe& other) {
  const Rigid3d other_from_this = other.camera_from_map * keyframe.camera_from_map.Inverse();
  const auto pixel_to_ray = [](const IdealCamera& camera) {
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Identity();
    inverse(0, 0) = 1.0 / camera.focal_x;
    inverse(1, 1) = 1.0 / camera.focal_y;
    inverse(0, 2) = -camera.center_x / camera.focal_x;
    inverse(1, 2) = -camera.center_y / camera.focal_y;
    return inverse;
  };
  const Eigen::Matrix3d essential = Skew(other_from_this.translation()) * other_from_this.rotation().toRotationMatrix();
  return pixel_to_ray(other.data->camera).transpose() * essential * pixel_to_ray(keyframe.data->camera);
}

// Best and second best candidate of a keypoint; the second is of another place.
struct Ranking {
  std::uint32_t best = 0;
  int distance = std::numeric_limits<int>::max();
  int second_distance = std::numeric_limits<int>::max();
};

bool SamePlace(const Keypoint& a, const Keypoint& b) {
  constexpr double kSameCorner = 2.0;  // octave pixels
  const double limit = kSameCorner * OctaveSigma(std::max(a.octave, b.octave));
  return std::abs(a.u - b.u) <= limit && std::abs(a.v - b.v) <= limit;
}

void Offer(Ranking& ranking, std::uint32_t candidate, int distance, const std::vector<Keypoint>& keypoints) {
  const bool same =
      ranking.distance < std::numeric_limits<int>::max() && SamePlace(keypoints[candidate], keypoints[ranking.best]);
  if (distance < ranking.distance) {
    if (!same) ranking.second_distance = ranking.distance;
    ranking.best = candidate;
    ranking.distance = distance;
  } else if (!same) {
    ranking.second_distance = std::min(ranking.second_distance, distance);
  }
}

bool Accept(const Ranking& ranking, const LandmarkCreationOptions& options) {
  return ranking.distance <= options.max_distance && ranking.distance <= options.max_ratio * ranking.second_distance;
}

std::vector<std::uint32_t> FreeKeypoints(const Keyframe& keyframe) {
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i < keyframe.landmarks.size(); ++i) {
    if (!keyframe.landmarks[i].valid()) indices.push_back(i);
  }
  return indices;
}

// Squared distance, below which a keypoint of each octave lies on the line.
std::array<double, kOctaves> SquaredLineWidths(const LandmarkCreationOptions& options,
                                               const MeasurementNoiseOptions& noise) {
  std::array<double, kOctaves> widths{};
  for (int octave = 0; octave < kOctaves; ++octave) {
    const double width = options.max_epipolar * noise.pixel_sigma * OctaveSigma(octave);
    widths[static_cast<std::size_t>(octave)] = width * width;
  }
  return widths;
}

PointView ViewOf(const Keyframe& keyframe, std::uint32_t index, const MeasurementNoiseOptions& noise) {
  const Keypoint& keypoint = keyframe.data->features.keypoints[index];
  return {.camera = keyframe.data->camera,
          .camera_from_map = keyframe.camera_from_map,
          .measurement = ReliableMeasurementOf(keyframe.data->camera, keypoint, noise),
          .inverse_sigma = 1.0 / SigmaOf(keypoint, noise)};
}

// A patch's size in the image falls with the distance: nearer views find it on a coarser octave.
bool OctavesFitDistances(const Keyframe& keyframe, const Keyframe& other, const TwoViewMatch& match,
                         const Eigen::Vector3d& point_in_map, double max_error) {
  const double distance = (keyframe.camera_from_map * point_in_map).norm();
  const double other_distance = (other.camera_from_map * point_in_map).norm();
  const double size = distance * OctaveSigma(keyframe.data->features.keypoints[match.keypoint].octave);
  const double other_size = other_distance * OctaveSigma(other.data->features.keypoints[match.other_keypoint].octave);
  return size < other_size * max_error && other_size < size * max_error;
}

}  // namespace

std::vector<TwoViewMatch> MatchAlongEpipolarLines(const Keyframe& keyframe, const Keyframe& other,
                                                  const std::vector<bool>& free, const LandmarkCreationOptions& options,
                                                  const MeasurementNoiseOptions& noise) {
  const Features& features = keyframe.data->features;
  const Features& other_features = other.data->features;
  const Eigen::Matrix3d fundamental = FundamentalMatrix(keyframe, other);
  const std::array<double, kOctaves> widths = SquaredLineWidths(options, noise);
  const std::vector<std::uint32_t> candidates = FreeKeypoints(other);
  std::vector<Ranking> forward(features.keypoints.size());
  std::vector<Ranking> backward(other_features.keypoints.size());

  for (std::uint32_t i = 0; i < features.keypoints.size(); ++i) {
    if (!free[i]) continue;
    const Eigen::Vector3d line = fundamental * Eigen::Vector3d(features.keypoints[i].u, features.keypoints[i].v, 1.0);
    const double squared_norm = line.head<2>().squaredNorm();
    if (squared_norm <= 0.0) continue;
    for (const std::uint32_t j : candidates) {
      const Keypoint& keypoint = other_features.keypoints[j];
      const double offset = line.x() * keypoint.u + line.y() * keypoint.v + line.z();
      if (offset * offset > widths[keypoint.octave] * squared_norm) continue;
      const int distance = HammingDistance(features.descriptors[i], other_features.descriptors[j]);
      Offer(forward[i], j, distance, other_features.keypoints);
      Offer(backward[j], i, distance, features.keypoints);
    }
  }

  std::vector<TwoViewMatch> matches;
  for (std::uint32_t i = 0; i < forward.size(); ++i) {
    if (Accept(forward[i], options) && backward[forward[i].best].best == i) matches.push_back({i, forward[i].best});
  }
  return matches;
}

std::optional<Eigen::Vector3d> TriangulateMatch(const Keyframe& keyframe, const Keyframe& other,
                                                const TwoViewMatch& match, const LandmarkCreationOptions& options,
                                                const MeasurementNoiseOptions& noise) {
  const std::array views{ViewOf(keyframe, match.keypoint, noise), ViewOf(other, match.other_keypoint, noise)};
  const auto ray = [](const PointView& view) {
    return PixelRay(view.camera, view.camera_from_map, view.measurement.head<2>());
  };
  const auto middle =
      TriangulateMidpoint(ray(views[0]), ray(views[1]), options.min_parallax * std::numbers::pi / 180.0);
  if (!middle) return std::nullopt;
  const auto refined = RefinePoint(views, *middle);
  if (!refined) return std::nullopt;
  const bool stereo = IsStereo(views[0].measurement) || IsStereo(views[1].measurement);
  if (refined->worst_chi2 > (stereo ? kStereoChi2 : kMonocularChi2)) return std::nullopt;
  if (!OctavesFitDistances(keyframe, other, match, refined->point_in_map, options.max_scale_error)) return std::nullopt;
  return refined->point_in_map;
}

}  // namespace pangaea
