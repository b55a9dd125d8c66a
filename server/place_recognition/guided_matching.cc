#include "server/place_recognition/guided_matching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>

#include "common/geometry/reprojection.h"
#include "common/mapping/view_prediction.h"

namespace pangaea {
namespace {

// An image in which landmarks of a place are looked for.
struct Target {
  const IdealCamera& camera;
  Similarity3d camera_from_center;
  Eigen::Vector3d position;  // of the camera, in the frame of the place
  double radius;
  double min_cosine;
  int octave_tolerance;
};

std::optional<ProjectionQuery> Predict(const PlaceView& place, std::size_t index, const Target& target) {
  const PlaceLandmark& landmark = place.landmarks[index];
  const Eigen::Vector3d point_in_camera = target.camera_from_center * landmark.point;
  if (!(point_in_camera.z() > kMinDepth)) return std::nullopt;
  const Eigen::Vector2d pixel = target.camera.Project(point_in_camera);
  if (!target.camera.Contains(pixel)) return std::nullopt;
  const Eigen::Vector3d old_ray = landmark.point - place.observers[landmark.first.observer].position;
  const Eigen::Vector3d new_ray = landmark.point - target.position;
  const double old_distance = old_ray.norm();
  const double new_distance = new_ray.norm();
  if (!(old_ray.dot(new_ray) > target.min_cosine * old_distance * new_distance)) return std::nullopt;
  const int octave = PredictOctave(place.keypoints[index].octave, old_distance, new_distance);
  const double disparity = target.camera.focal_x * target.camera.baseline / point_in_camera.z();
  return ProjectionQuery{.u = static_cast<float>(pixel.x()),
                         .v = static_cast<float>(pixel.y()),
                         .u_right = target.camera.is_stereo() ? static_cast<float>(pixel.x() - disparity) : -1.0F,
                         .radius = static_cast<float>(target.radius * OctaveSigma(std::clamp(octave, 0, kOctaves - 1))),
                         .min_octave = std::max(0, octave - target.octave_tolerance),
                         .max_octave = std::min(kOctaves - 1, octave + target.octave_tolerance),
                         .descriptor = place.descriptors[index]};
}

GuidedSearch SearchInCentralImage(const PlaceView& place, const PlaceView& other, const Similarity3d& other_from_place,
                                  double radius, const PlaceGeometryOptions& options) {
  return SearchInImage(place, *other.center().data, other.grid, other_from_place, radius, options);
}

// The nearest pairs first, as long as neither landmark is taken.
std::vector<Match> KeepOnePerLandmark(std::vector<Match> pairs, std::size_t queries, std::size_t candidates) {
  std::ranges::sort(pairs, [](const Match& a, const Match& b) {
    return std::tie(a.distance, a.query, a.train) < std::tie(b.distance, b.query, b.train);
  });
  std::vector<bool> query_taken(queries, false);
  std::vector<bool> candidate_taken(candidates, false);
  std::erase_if(pairs, [&](const Match& pair) {
    if (query_taken[pair.query] || candidate_taken[pair.train]) return true;
    query_taken[pair.query] = candidate_taken[pair.train] = true;
    return false;
  });
  std::ranges::sort(pairs, {}, &Match::query);
  return pairs;
}

constexpr int kCellColumns = 8;
constexpr int kCellRows = 5;
// Landmarks that should be in a cell for their absence to mean something: most of what is in view is not found again.
constexpr int kExpectedInCell = 8;

// Which parts of the image hold what they should.
class CellCount {
 public:
  explicit CellCount(const IdealCamera& camera) : camera_(camera) {}
  void Expect(const ProjectionQuery& query) { ++expected_[CellOf(query)]; }
  void Confirm(const ProjectionQuery& query) { ++found_[CellOf(query)]; }
  void Count(GuidedSearch& search) const {
    for (std::size_t i = 0; i < expected_.size(); ++i) {
      if (expected_[i] < kExpectedInCell) continue;
      ++search.expected_cells;
      search.confirmed_cells += found_[i] > 0 ? 1 : 0;
    }
  }

 private:
  std::size_t CellOf(const ProjectionQuery& query) const {
    const int column = static_cast<int>(query.u / static_cast<float>(camera_.width) * kCellColumns);
    const int row = static_cast<int>(query.v / static_cast<float>(camera_.height) * kCellRows);
    return static_cast<std::size_t>(std::clamp(row, 0, kCellRows - 1) * kCellColumns +
                                    std::clamp(column, 0, kCellColumns - 1));
  }

  const IdealCamera& camera_;
  std::array<int, kCellColumns * kCellRows> expected_{};
  std::array<int, kCellColumns * kCellRows> found_{};
};

}  // namespace

GuidedSearch SearchInImage(const PlaceView& place, const KeyframeData& image, const FeatureGrid& grid,
                           const Similarity3d& camera_from_center, double radius, const PlaceGeometryOptions& options) {
  const Target target{.camera = image.camera,
                      .camera_from_center = camera_from_center,
                      .position = camera_from_center.Inverse().translation(),
                      .radius = radius,
                      .min_cosine = std::cos(options.max_view_angle * std::numbers::pi / 180.0),
                      .octave_tolerance = options.octave_tolerance};
  std::vector<ProjectionQuery> queries;
  std::vector<std::uint32_t> landmarks;
  for (std::uint32_t i = 0; i < place.landmarks.size(); ++i) {
    const auto query = Predict(place, i, target);
    if (!query) continue;
    queries.push_back(*query);
    landmarks.push_back(i);
  }
  GuidedSearch search;
  search.visible = queries.size();
  search.matches = MatchByProjection(queries, grid, image.features.descriptors, options.guided_matching);
  CellCount cells(image.camera);
  for (const ProjectionQuery& query : queries) cells.Expect(query);
  for (Match& match : search.matches) {
    cells.Confirm(queries[match.query]);
    match.query = landmarks[match.query];
  }
  cells.Count(search);
  return search;
}

std::vector<Match> SearchLandmarkPairs(const PlaceView& query, const PlaceView& candidate,
                                       const Similarity3d& candidate_from_query, double radius,
                                       const PlaceGeometryOptions& options) {
  std::vector<Match> pairs;
  for (const Match& match : SearchInCentralImage(query, candidate, candidate_from_query, radius, options).matches) {
    const std::uint32_t landmark = candidate.landmark_at[match.train];
    if (landmark != PlaceView::kNone) pairs.push_back({match.query, landmark, match.distance});
  }
  const Similarity3d query_from_candidate = candidate_from_query.Inverse();
  for (const Match& match : SearchInCentralImage(candidate, query, query_from_candidate, radius, options).matches) {
    const std::uint32_t landmark = query.landmark_at[match.train];
    if (landmark != PlaceView::kNone) pairs.push_back({landmark, match.query, match.distance});
  }
  return KeepOnePerLandmark(std::move(pairs), query.landmarks.size(), candidate.landmarks.size());
}

}  // namespace pangaea
