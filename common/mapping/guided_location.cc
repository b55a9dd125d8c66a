#include "common/mapping/guided_location.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/check.h"
#include "common/base/median.h"
#include "common/features/feature_grid.h"
#include "common/mapping/view_prediction.h"

namespace pangaea {
namespace {

class Search {
 public:
  Search(const IdealCamera& camera, const Features& features, const Atlas& atlas,
         std::span<const SoughtLandmark> sought, const GuidedSearchOptions& options)
      : camera_(camera),
        features_(features),
        grid_(features.keypoints),
        atlas_(atlas),
        sought_(sought),
        options_(options) {}

  std::optional<GuidedLocation> Locate(const Rigid3d& camera_from_map, double radius) const {
    std::vector<std::uint32_t> asked;
    const std::vector<ProjectionQuery> queries = Queries(camera_from_map, radius, asked);
    const auto matches = MatchByProjection(queries, grid_, features_.descriptors, options_.matching);
    const Eigen::Vector3d camera_in_map = camera_from_map.Inverse().translation();
    std::vector<GuidedMatch> found;
    std::vector<PoseObservation> observations;
    for (const Match& match : matches) {
      found.push_back(MatchOf(asked[match.query], match.train, camera_in_map));
      const Keypoint& keypoint = features_.keypoints[match.train];
      observations.push_back({atlas_.FindLandmark(sought_[asked[match.query]].id)->point_in_map,
                              {keypoint.u, keypoint.v, -1.0},
                              1.0 / found.back().sigma});
    }
    std::vector<std::uint8_t> inliers(found.size());
    const auto refined = RefinePose(camera_, camera_from_map, observations, options_.refinement, inliers);
    if (!refined) return std::nullopt;
    GuidedLocation location{*refined, {}, static_cast<int>(queries.size()), static_cast<int>(found.size())};
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (inliers[i] != 0) location.matches.push_back(found[i]);
    }
    return location;
  }

 private:
  // `asked`: the landmark of each query.
  std::vector<ProjectionQuery> Queries(const Rigid3d& camera_from_map, double radius,
                                       std::vector<std::uint32_t>& asked) const {
    const Viewpoint viewpoint(camera_, camera_from_map);
    std::vector<ProjectionQuery> queries;
    for (std::uint32_t i = 0; i < sought_.size(); ++i) {
      const Landmark* landmark = atlas_.FindLandmark(sought_[i].id);
      PANGAEA_CHECK(landmark != nullptr);
      const auto view = PredictView(atlas_, *landmark, viewpoint, options_.max_view_angle);
      if (!view) continue;
      queries.push_back(MakeProjectionQuery(atlas_, *view, radius, options_.octave_tolerance));
      queries.back().u_right = -1.0F;  // the frame's keypoints have no depth yet
      asked.push_back(i);
    }
    return queries;
  }

  GuidedMatch MatchOf(std::uint32_t landmark, std::uint32_t keypoint, const Eigen::Vector3d& camera_in_map) const {
    constexpr double kMaxVariance = 100.0;  // beyond it the landmark still tells the rotation
    const double variance = std::min(PredictionVariance(sought_[landmark].observers, camera_in_map), kMaxVariance);
    const int octave = features_.keypoints[keypoint].octave;
    return {landmark, keypoint, options_.sigma * OctaveSigma(octave) * std::sqrt(variance)};
  }

  const IdealCamera& camera_;
  const Features& features_;
  const FeatureGrid grid_;
  const Atlas& atlas_;
  const std::span<const SoughtLandmark> sought_;
  const GuidedSearchOptions& options_;
};

}  // namespace

std::optional<GuidedLocation> LocateByDescriptors(const IdealCamera& camera, const Features& features,
                                                  const Atlas& atlas, const Rigid3d& rough_camera_from_map,
                                                  std::span<const SoughtLandmark> sought,
                                                  const GuidedSearchOptions& options) {
  const Search search(camera, features, atlas, sought, options);
  const auto first = search.Locate(rough_camera_from_map, options.first_radius);
  if (!first) return std::nullopt;
  return search.Locate(first->pose.camera_from_map, options.radius);
}

double MedianDepth(const GuidedLocation& location, const Atlas& atlas, std::span<const SoughtLandmark> sought) {
  std::vector<double> depths;
  for (const GuidedMatch& match : location.matches) {
    const Landmark* landmark = atlas.FindLandmark(sought[match.landmark].id);
    PANGAEA_CHECK(landmark != nullptr);
    depths.push_back((location.pose.camera_from_map * landmark->point_in_map).z());
  }
  return Median(std::move(depths));
}

}  // namespace pangaea
