#include "tests/place/revisits.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace pangaea::testing {
namespace {

constexpr double kNeighbourhood = 10.0;        // pixels
constexpr double kLeastDisparity = 1.5;        // pixels: points farther away have no useful depth
constexpr double kDepthTolerance = 0.05;       // as a share
constexpr double kDepthToleranceFixed = 0.05;  // metres

struct StereoPoint {
  Eigen::Vector2d pixel;
  Eigen::Vector3d in_camera;
};

std::vector<StereoPoint> StereoPoints(const SurveyedKeyframe& keyframe) {
  const IdealCamera& camera = keyframe.camera;
  std::vector<StereoPoint> points;
  for (const Keypoint& keypoint : keyframe.features.keypoints) {
    const double disparity = static_cast<double>(keypoint.u) - static_cast<double>(keypoint.u_right);
    if (!keypoint.has_depth() || disparity < kLeastDisparity) continue;
    const Eigen::Vector2d pixel(keypoint.u, keypoint.v);
    points.push_back({pixel, camera.Unproject(pixel) * (camera.focal_x * camera.baseline / disparity)});
  }
  return points;
}

bool Sees(const std::vector<StereoPoint>& points, const Eigen::Vector2d& pixel, double depth) {
  const StereoPoint* nearest = nullptr;
  double least = kNeighbourhood;
  for (const StereoPoint& point : points) {
    const double distance = (point.pixel - pixel).norm();
    if (distance >= least) continue;
    least = distance;
    nearest = &point;
  }
  return nearest != nullptr &&
         std::abs(nearest->in_camera.z() - depth) < kDepthTolerance * depth + kDepthToleranceFixed;
}

bool IsNear(const SurveyedKeyframe& a, const SurveyedKeyframe& b, const RevisitLimits& limits) {
  const Rigid3d a_from_b = a.world_from_body.Inverse() * b.world_from_body;
  return a_from_b.translation().norm() <= limits.distance &&
         a_from_b.rotation().angularDistance(Eigen::Quaterniond::Identity()) <= limits.angle * std::numbers::pi / 180.0;
}

KeyframeId IdOf(std::size_t keyframe) { return {1, static_cast<std::uint32_t>(keyframe + 1)}; }

}  // namespace

double SharedView(const SurveyedKeyframe& a, const SurveyedKeyframe& b) {
  const Rigid3d b_from_a = b.world_from_camera.Inverse() * a.world_from_camera;
  const std::vector<StereoPoint> points_of_a = StereoPoints(a), points_of_b = StereoPoints(b);
  std::size_t shared = 0;
  for (const StereoPoint& point : points_of_a) {
    const Eigen::Vector3d in_b = b_from_a * point.in_camera;
    if (in_b.z() > 0.1 && Sees(points_of_b, b.camera.Project(in_b), in_b.z())) ++shared;
  }
  return points_of_a.empty() ? 0.0 : static_cast<double>(shared) / static_cast<double>(points_of_a.size());
}

std::vector<Lookup> LookUpAll(const std::vector<SurveyedKeyframe>& keyframes, const VocabularyTree& vocabulary,
                              const RevisitLimits& limits) {
  InvertedIndex index(vocabulary.words());
  std::vector<Lookup> lookups;
  for (std::size_t i = limits.least_gap + 1; i < keyframes.size(); ++i) {
    const std::size_t newest = i - limits.least_gap - 1;
    index.Add(IdOf(newest), vocabulary.Bag(keyframes[newest].features.descriptors));
    Lookup lookup;
    lookup.keyframe = i;
    for (std::size_t j = 0; j <= newest; ++j) lookup.is_revisit |= IsNear(keyframes[i], keyframes[j], limits);
    const PlaceCandidates found = index.Query(vocabulary.Bag(keyframes[i].features.descriptors));
    if (!found.ranked.empty()) {
      lookup.candidate = found.ranked.front().keyframe.counter - 1;
      lookup.score = found.ranked.front().score;
      lookup.candidate_is_right = SharedView(keyframes[i], keyframes[*lookup.candidate]) >= limits.shared_view;
    }
    lookups.push_back(lookup);
  }
  return lookups;
}

std::vector<PrecisionRecall> PrecisionRecallCurve(std::vector<Lookup> lookups) {
  std::ranges::stable_sort(lookups, std::ranges::greater(), &Lookup::score);
  const auto revisits = static_cast<double>(std::ranges::count(lookups, true, &Lookup::is_revisit));
  std::vector<PrecisionRecall> curve;
  double accepted = 0.0, right = 0.0, found = 0.0;
  for (const Lookup& lookup : lookups) {
    if (!lookup.candidate) continue;
    accepted += 1.0;
    right += lookup.candidate_is_right ? 1.0 : 0.0;
    found += lookup.candidate_is_right && lookup.is_revisit ? 1.0 : 0.0;
    curve.push_back({lookup.score, right / accepted, found / revisits});
  }
  return curve;
}

double RecallAtFullPrecision(const std::vector<PrecisionRecall>& curve) {
  double recall = 0.0;
  for (const PrecisionRecall& point : curve) {
    if (point.precision < 1.0) break;
    recall = point.recall;
  }
  return recall;
}

}  // namespace pangaea::testing
