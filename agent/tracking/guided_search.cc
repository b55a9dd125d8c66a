#include "agent/tracking/guided_search.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"
#include "common/features/feature_grid.h"
#include "common/mapping/view_prediction.h"

namespace pangaea {
namespace {

class Search {
 public:
  Search(const IdealCamera& camera, const Features& features, const Atlas& atlas, const LocalMap& local_map,
         const GuidedSearchOptions& options)
      : camera_(camera),
        features_(features),
        grid_(features.keypoints),
        atlas_(atlas),
        local_map_(local_map),
        options_(options) {}

  std::optional<GuidedFrame> Locate(const Rigid3d& camera_from_map, double radius) const {
    std::vector<int> asked;
    const std::vector<ProjectionQuery> queries = Queries(camera_from_map, radius, asked);
    const auto matches = MatchByProjection(queries, grid_, features_.descriptors, options_.matching);
    const Eigen::Vector3d camera_in_map = camera_from_map.Inverse().translation();
    std::vector<LandmarkMatch> found;
    std::vector<PoseObservation> observations;
    for (const Match& match : matches) {
      found.push_back(MatchOf(asked[match.query], features_.keypoints[match.train], camera_in_map));
      observations.push_back({local_map_.landmarks[static_cast<std::size_t>(asked[match.query])].point_in_map,
                              {found.back().pixel.x(), found.back().pixel.y(), -1.0},
                              1.0 / found.back().sigma});
    }
    std::vector<std::uint8_t> inliers(found.size());
    const auto refined = RefinePose(camera_, camera_from_map, observations, options_.refinement, inliers);
    if (!refined) return std::nullopt;
    GuidedFrame frame{{*refined, {}, static_cast<int>(queries.size()), static_cast<int>(found.size())}, {}};
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (inliers[i] == 0) continue;
      frame.located.matches.push_back(found[i]);
      frame.keypoints.push_back(matches[i].train);
    }
    return frame;
  }

 private:
  // `asked`: the landmark of each query.
  std::vector<ProjectionQuery> Queries(const Rigid3d& camera_from_map, double radius, std::vector<int>& asked) const {
    const Viewpoint viewpoint(camera_, camera_from_map);
    std::vector<ProjectionQuery> queries;
    for (int i = 0; i < static_cast<int>(local_map_.landmarks.size()); ++i) {
      const Landmark* landmark = atlas_.FindLandmark(local_map_.landmarks[static_cast<std::size_t>(i)].id);
      PANGAEA_CHECK(landmark != nullptr);
      const auto view = PredictView(atlas_, *landmark, viewpoint, options_.max_view_angle);
      if (!view) continue;
      queries.push_back(MakeProjectionQuery(atlas_, *view, radius, options_.octave_tolerance));
      queries.back().u_right = -1.0F;  // the frame's keypoints have no depth yet
      asked.push_back(i);
    }
    return queries;
  }

  LandmarkMatch MatchOf(int landmark, const Keypoint& keypoint, const Eigen::Vector3d& camera_in_map) const {
    constexpr double kMaxVariance = 100.0;  // beyond it the landmark still tells the rotation
    const double variance = std::min(
        PredictionVariance(local_map_.landmarks[static_cast<std::size_t>(landmark)], camera_in_map), kMaxVariance);
    LandmarkMatch match;
    match.landmark = landmark;
    match.pixel = {keypoint.u, keypoint.v};
    match.octave = keypoint.octave;
    match.sigma = options_.sigma * OctaveSigma(keypoint.octave) * std::sqrt(variance);
    return match;
  }

  const IdealCamera& camera_;
  const Features& features_;
  const FeatureGrid grid_;
  const Atlas& atlas_;
  const LocalMap& local_map_;
  const GuidedSearchOptions& options_;
};

}  // namespace

std::optional<GuidedFrame> LocateByDescriptors(const IdealCamera& camera, const Features& features, const Atlas& atlas,
                                               const Rigid3d& rough_camera_from_map, const LocalMap& local_map,
                                               const GuidedSearchOptions& options) {
  const Search search(camera, features, atlas, local_map, options);
  const auto first = search.Locate(rough_camera_from_map, options.first_radius);
  if (!first) return std::nullopt;
  return search.Locate(first->located.pose.camera_from_map, options.radius);
}

}  // namespace pangaea
