#include "agent/tracking/patch_search.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/geometry/keypoint.h"

namespace pangaea {
namespace {

// A landmark expected in the image.
struct Expected {
  int landmark;
  Eigen::Vector2d pixel;
  double priority;
};

// What was tracked a moment ago will be seen again; among the others, well-established landmarks are the surest.
double Priority(const LocalLandmark& landmark) {
  constexpr double kTracked = 100.0;
  constexpr double kFailure = 8.0;
  constexpr int kSaturated = 30;  // observations beyond this say nothing more
  return (landmark.tracked ? kTracked : 0.0) + std::min(landmark.observers.observations, kSaturated) -
         kFailure * std::min(landmark.failures, kSaturated);
}

std::vector<Expected> PredictVisible(const IdealCamera& camera, const Rigid3d& camera_from_map,
                                     const LocalMap& local_map, const PatchSearchOptions& options) {
  std::vector<Expected> visible;
  const Eigen::Matrix3d rotation = camera_from_map.rotation().toRotationMatrix();
  for (int i = 0; i < static_cast<int>(local_map.landmarks.size()); ++i) {
    const LocalLandmark& landmark = local_map.landmarks[i];
    if (landmark.view_count == 0) continue;
    const Eigen::Vector3d point = rotation * landmark.point_in_map + camera_from_map.translation();
    if (point.z() <= 0.0) continue;
    const Eigen::Vector2d pixel = camera.Project(point);
    if (camera.Contains(pixel, options.border)) visible.push_back({i, pixel, Priority(landmark)});
  }
  std::stable_sort(visible.begin(), visible.end(),
                   [](const Expected& a, const Expected& b) { return a.priority > b.priority; });
  return visible;
}

// Orders the visible landmarks so that any prefix of them is spread evenly: the best of every cell, then the second
// best of every cell, and so on.
std::vector<Expected> SpreadEvenly(const std::vector<Expected>& visible, const IdealCamera& camera,
                                   const PatchSearchOptions& options) {
  const int cells = options.grid_columns * options.grid_rows;
  std::vector<std::vector<int>> by_cell(cells);
  for (int i = 0; i < static_cast<int>(visible.size()); ++i) {
    const int column = static_cast<int>(visible[i].pixel.x() * options.grid_columns / camera.width);
    const int row = static_cast<int>(visible[i].pixel.y() * options.grid_rows / camera.height);
    by_cell[row * options.grid_columns + column].push_back(i);
  }
  std::vector<Expected> spread;
  const auto wanted = std::min(visible.size(), static_cast<std::size_t>(options.max_landmarks));
  for (std::size_t rank = 0; spread.size() < wanted; ++rank) {
    for (const std::vector<int>& cell : by_cell) {
      if (rank < cell.size() && spread.size() < wanted) spread.push_back(visible[cell[rank]]);
    }
  }
  return spread;
}

// Of the angle at the landmark between a view of it and the present one.
double ViewCosine(const LocalLandmark& landmark, const Rigid3d& view_from_map, const Eigen::Vector3d& camera_in_map) {
  const Eigen::Vector3d direction = (landmark.point_in_map - camera_in_map).normalized();
  const Eigen::Vector3d in_view = view_from_map * landmark.point_in_map;
  return direction.dot((view_from_map.rotation().conjugate() * in_view).normalized());
}

// The view whose direction is nearest to the present one, if any is near enough.
const LandmarkView* NearestView(const LocalLandmark& landmark, const std::vector<Rigid3d>& view_poses,
                                const Eigen::Vector3d& camera_in_map, double min_cosine) {
  const LandmarkView* nearest = nullptr;
  double best = min_cosine;
  for (int i = 0; i < landmark.view_count; ++i) {
    const double cosine = ViewCosine(landmark, view_poses[landmark.views[i].pose], camera_in_map);
    if (cosine <= best) continue;
    best = cosine;
    nearest = &landmark.views[i];
  }
  return nearest;
}

class Searcher {
 public:
  Searcher(const ImagePyramid& image, const IdealCamera& camera, LocalMap& local_map, const PatchSearchOptions& options)
      : image_(image), camera_(camera), local_map_(local_map), options_(options) {}

  void SetPose(const Rigid3d& camera_from_map) {
    camera_from_map_ = camera_from_map;
    camera_in_map_ = camera_from_map.Inverse().translation();
  }

  // Looks for one landmark where the pose expects it; remembers it when found.
  void Search(const Expected& expected, bool coarse) {
    LocalLandmark& landmark = local_map_.landmarks[expected.landmark];
    const Eigen::Vector2d beside = ExpectedBeside(landmark);
    const std::optional<LandmarkMatch> match = Find(expected.landmark, landmark, beside, coarse);
    landmark.failures = match ? 0 : landmark.failures + 1;
    if (!match) return;
    matches_.push_back(*match);
    PoseObservation& observation = observations_.emplace_back();
    observation.point_in_map = landmark.point_in_map;
    observation.measurement = Eigen::Vector3d(match->pixel.x() - beside.x(), match->pixel.y() - beside.y(), -1.0);
    observation.inverse_sigma = 1.0 / match->sigma;
  }

  std::optional<RefinedPose> Refine(const Rigid3d& initial) {
    inliers_.resize(observations_.size());
    return RefinePose(camera_, initial, observations_, options_.refinement, inliers_);
  }

  std::size_t found() const { return matches_.size(); }
  std::vector<LandmarkMatch> TakeInliers() const {
    std::vector<LandmarkMatch> result;
    for (std::size_t i = 0; i < matches_.size(); ++i) {
      if (inliers_[i] != 0) result.push_back(matches_[i]);
    }
    return result;
  }

 private:
  // The affine map from pixels of that view to the present ones, around the landmark.
  std::optional<Eigen::Matrix2d> CurrentFromView(std::size_t pose, const LocalLandmark& landmark) const {
    const Rigid3d& view_from_map = local_map_.view_poses[pose];
    return CurrentFromTemplate(camera_, camera_from_map_ * view_from_map.Inverse(),
                               view_from_map * landmark.point_in_map);
  }

  // Where the corner is expected beside the landmark's point: where it was seen last, if that view is near enough to
  // the present one for a patch to be found again. Pixels.
  Eigen::Vector2d ExpectedBeside(const LocalLandmark& landmark) const {
    const std::optional<Sighting>& sighting = landmark.latest_sighting;
    if (!sighting) return Eigen::Vector2d::Zero();
    const double cosine = ViewCosine(landmark, local_map_.view_poses[sighting->pose], camera_in_map_);
    if (cosine <= options_.min_view_cosine) return Eigen::Vector2d::Zero();
    const auto affine = CurrentFromView(sighting->pose, landmark);
    if (!affine || !CanBeAligned(*affine)) return Eigen::Vector2d::Zero();
    return *affine * sighting->beside;
  }

  std::optional<LandmarkMatch> Find(int index, const LocalLandmark& landmark, const Eigen::Vector2d& beside,
                                    bool coarse) const {
    const LandmarkView* view = NearestView(landmark, local_map_.view_poses, camera_in_map_, options_.min_view_cosine);
    if (view == nullptr) return std::nullopt;
    const Eigen::Vector3d point = camera_from_map_ * landmark.point_in_map;
    if (point.z() <= 0.0) return std::nullopt;
    const auto affine = CurrentFromView(view->pose, landmark);
    if (!affine) return std::nullopt;
    const Eigen::Vector2d predicted = camera_.Project(point) + beside;
    const auto aligned = AlignPatch(image_, *view->patch, *affine, predicted, coarse, options_.alignment);
    if (!aligned) return std::nullopt;
    LandmarkMatch match;
    match.landmark = index;
    match.pixel = aligned->pixel;
    const double octaves = 0.5 * std::log(affine->determinant()) / std::log(kOctaveScale);
    match.octave = std::clamp(view->patch->octave + static_cast<int>(std::lround(octaves)), 0, kOctaves - 1);
    const double variance =
        std::min(PredictionVariance(landmark.observers, camera_in_map_), options_.max_prediction_variance);
    match.sigma = std::ldexp(options_.patch_sigma, aligned->level) * std::sqrt(variance);
    match.correlation = aligned->correlation;
    return match;
  }

  const ImagePyramid& image_;
  const IdealCamera& camera_;
  LocalMap& local_map_;
  const PatchSearchOptions& options_;
  Rigid3d camera_from_map_;
  Eigen::Vector3d camera_in_map_ = Eigen::Vector3d::Zero();
  std::vector<LandmarkMatch> matches_;
  std::vector<PoseObservation> observations_;
  std::vector<std::uint8_t> inliers_;
};

}  // namespace

std::optional<LocatedFrame> LocateFrame(const ImagePyramid& image, const IdealCamera& camera,
                                        const Rigid3d& predicted_camera_from_map, LocalMap& local_map,
                                        const PatchSearchOptions& options) {
  Searcher searcher(image, camera, local_map, options);
  searcher.SetPose(predicted_camera_from_map);
  const std::vector<Expected> expected =
      SpreadEvenly(PredictVisible(camera, predicted_camera_from_map, local_map, options), camera, options);
  const std::size_t scouts = std::min(expected.size(), static_cast<std::size_t>(options.scouts));
  for (std::size_t i = 0; i < scouts; ++i) searcher.Search(expected[i], true);
  Rigid3d pose = predicted_camera_from_map;
  if (searcher.found() >= static_cast<std::size_t>(options.min_scouts)) {
    if (const auto corrected = searcher.Refine(pose)) pose = corrected->camera_from_map;
  }
  searcher.SetPose(pose);
  for (std::size_t i = scouts; i < expected.size(); ++i) searcher.Search(expected[i], false);
  for (LocalLandmark& landmark : local_map.landmarks) landmark.tracked = false;
  const auto refined = searcher.Refine(pose);
  if (!refined) return std::nullopt;
  LocatedFrame located{*refined, searcher.TakeInliers(), static_cast<int>(expected.size()),
                       static_cast<int>(searcher.found())};
  for (const LandmarkMatch& match : located.matches) local_map.landmarks[match.landmark].tracked = true;
  return located;
}

}  // namespace pangaea
