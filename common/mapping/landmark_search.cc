#include "common/mapping/landmark_search.h"

#include <algorithm>

#include "common/features/feature_grid.h"
#include "common/features/matching.h"
#include "common/geometry/reprojection.h"
#include "common/mapping/measurement_noise.h"
#include "common/mapping/view_prediction.h"

namespace pangaea {
namespace {

// Whether the landmark was last seen so long before the keyframe that it may be off by the drift since.
bool IsOld(const Landmark& landmark, const Keyframe& keyframe, const LandmarkSearchOptions& options) {
  const KeyframeId newest = landmark.observations.back().keyframe;
  return newest.session != keyframe.id.session || newest.counter + options.old_after < keyframe.id.counter;
}

// What most landmarks fail, before anything that costs more.
class ImageCheck {
 public:
  explicit ImageCheck(const Viewpoint& viewpoint)
      : camera_(viewpoint.camera),
        rotation_(viewpoint.camera_from_map.rotation().toRotationMatrix()),
        translation_(viewpoint.camera_from_map.translation()) {}

  bool Contains(const Eigen::Vector3d& point_in_map) const {
    const Eigen::Vector3d point = rotation_ * point_in_map + translation_;
    return point.z() > 0.0 && camera_.Contains(camera_.Project(point));
  }

 private:
  const IdealCamera& camera_;
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d translation_;
};

bool Observes(KeyframeId id, const Landmark& landmark) {
  return std::ranges::binary_search(landmark.observations, id, {}, &Observation::keyframe);
}

const Keypoint& KeypointOf(const Atlas& atlas, const Observation& observation) {
  return atlas.FindKeyframe(observation.keyframe)->data->features.keypoints[observation.keypoint];
}

// Whether the point lies within `gate` octave pixels of where each observer of `landmark` saw it.
bool ExplainsObservations(const Atlas& atlas, const Eigen::Vector3d& point_in_map, const Landmark& landmark,
                          double gate) {
  return std::all_of(landmark.observations.begin(), landmark.observations.end(), [&](const Observation& observation) {
    const Keyframe& observer = *atlas.FindKeyframe(observation.keyframe);
    const Keypoint& keypoint = observer.data->features.keypoints[observation.keypoint];
    const Eigen::Vector3d point = observer.camera_from_map * point_in_map;
    if (point.z() < kMinDepth) return false;
    const Eigen::Vector3d error = ReprojectionError(observer.data->camera, point, MeasurementOf(keypoint));
    const double disparity_error = error.z() / kDisparityPrecision;
    const double farthest = std::max(error.head<2>().lpNorm<Eigen::Infinity>(), std::abs(disparity_error));
    return farthest <= gate * OctaveSigma(keypoint.octave);
  });
}

}  // namespace

bool SeenApart(const Atlas& atlas, const Landmark& a, const Landmark& b) {
  constexpr double kSameCorner = 2.0;  // octave pixels: detections of one corner on neighbouring octaves differ by less
  auto second = b.observations.begin();
  for (const Observation& first : a.observations) {
    while (second != b.observations.end() && second->keyframe < first.keyframe) ++second;
    if (second == b.observations.end()) return false;
    if (second->keyframe != first.keyframe) continue;
    const Keypoint& p = KeypointOf(atlas, first);
    const Keypoint& q = KeypointOf(atlas, *second);
    const double limit = kSameCorner * OctaveSigma(std::max(p.octave, q.octave));
    if (std::abs(p.u - q.u) > limit || std::abs(p.v - q.v) > limit) return true;
  }
  return false;
}

std::optional<MapEdit> FuseIfTheyAgree(const Atlas& atlas, const Landmark& a, const Landmark& b, double gate) {
  const bool keep_a =
      a.observations.size() != b.observations.size() ? a.observations.size() > b.observations.size() : a.id < b.id;
  const Landmark& kept = keep_a ? a : b;
  const Landmark& absorbed = keep_a ? b : a;
  if (SeenApart(atlas, kept, absorbed)) return std::nullopt;
  if (!ExplainsObservations(atlas, kept.point_in_map, absorbed, gate)) return std::nullopt;
  if (!ExplainsObservations(atlas, absorbed.point_in_map, kept, gate)) return std::nullopt;
  return FuseLandmarks{.kept = kept.id, .absorbed = absorbed.id};
}

std::vector<LandmarkSighting> FindLandmarks(const Atlas& atlas, const Keyframe& keyframe,
                                            const std::vector<LandmarkId>& wanted,
                                            const LandmarkSearchOptions& options) {
  const Viewpoint viewpoint(keyframe);
  const ImageCheck image(viewpoint);
  const Features& features = keyframe.data->features;
  std::vector<LandmarkSighting> queries;
  std::vector<ProjectionQuery> projections;
  for (const LandmarkId id : wanted) {
    const Landmark* landmark = atlas.FindLandmark(id);
    if (landmark == nullptr || !image.Contains(landmark->point_in_map) || Observes(keyframe.id, *landmark)) continue;
    const auto view = PredictView(atlas, *landmark, viewpoint, options.max_view_angle);
    if (!view) continue;
    const bool old = IsOld(*landmark, keyframe, options);
    queries.push_back({.landmark = id, .keypoint = 0, .old = old});
    projections.push_back(
        MakeProjectionQuery(atlas, *view, old ? options.old_radius : options.radius, options.octave_tolerance));
  }

  const FeatureGrid grid(features.keypoints);
  const MatchOptions match_options{
      .max_distance = options.max_distance, .max_ratio = options.max_ratio, .unique = options.one_per_keypoint};
  std::vector<LandmarkSighting> sightings;
  for (const Match& match : MatchByProjection(projections, grid, features.descriptors, match_options)) {
    sightings.push_back(queries[match.query]);
    sightings.back().keypoint = match.train;
  }
  return sightings;
}

std::vector<MapEdit> SearchLandmarks(const Atlas& atlas, const Keyframe& keyframe,
                                     const std::vector<LandmarkId>& wanted, const LandmarkSearchOptions& options) {
  std::vector<MapEdit> edits;
  for (const LandmarkSighting& sighting : FindLandmarks(atlas, keyframe, wanted, options)) {
    const LandmarkId present = keyframe.landmarks[sighting.keypoint];
    if (!present.valid()) {
      edits.push_back(AddObservation{sighting.landmark, keyframe.id, sighting.keypoint});
      continue;
    }
    const Landmark& other = *atlas.FindLandmark(present);
    const double gate = sighting.old || IsOld(other, keyframe, options) ? options.old_radius : options.fusion_gate;
    auto fusion = FuseIfTheyAgree(atlas, *atlas.FindLandmark(sighting.landmark), other, gate);
    if (fusion) edits.push_back(std::move(*fusion));
  }
  return edits;
}

}  // namespace pangaea
