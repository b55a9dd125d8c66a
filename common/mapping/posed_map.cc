#include "common/mapping/posed_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/check.h"
#include "common/base/median.h"
#include "common/base/range_check.h"
#include "common/estimation/bundle_adjustment.h"
#include "common/geometry/reprojection.h"
#include "common/map/covisibility.h"
#include "common/map/edits/point_form.h"
#include "common/map/map_edit.h"
#include "common/map/spanning_tree.h"
#include "common/mapping/bundle_window.h"
#include "common/mapping/landmark_creation.h"
#include "common/mapping/view_overlap.h"

namespace pangaea {
namespace {

void WriteDown(const Atlas& atlas, const Landmark& landmark, std::vector<MapEdit>& edits) {
  const Keyframe& reference = *atlas.FindKeyframe(landmark.reference);
  const auto seen = std::ranges::find(landmark.observations, landmark.reference, &Observation::keyframe);
  edits.push_back(AddLandmark{.id = landmark.id,
                              .reference = reference.id,
                              .keypoint = seen->keypoint,
                              .point_in_reference = QuantizePoint(reference.camera_from_map * landmark.point_in_map)});
  for (const Observation& observation : landmark.observations) {
    if (observation.keyframe == reference.id) continue;
    edits.push_back(AddObservation{landmark.id, observation.keyframe, observation.keypoint});
  }
}

// From nothing to the closed map, without the detours on which it came to be.
std::vector<MapEdit> ShortestEdits(const Atlas& atlas, MapId map) {
  std::vector<MapEdit> edits;
  for (const KeyframeId id : ParentsFirst(atlas, map)) {
    const Keyframe& keyframe = *atlas.FindKeyframe(id);
    const Keyframe* parent = atlas.FindKeyframe(keyframe.parent);
    const Rigid3d parent_from_map = parent == nullptr ? Rigid3d() : parent->camera_from_map;
    edits.push_back(AddKeyframe{.id = id,
                                .map = map,
                                .parent = keyframe.parent,
                                .camera_from_parent = keyframe.camera_from_map * parent_from_map.Inverse(),
                                .data = keyframe.data});
  }
  atlas.ForEachLandmark([&](const Landmark& landmark) { WriteDown(atlas, landmark, edits); });
  edits.push_back(CloseMap{.map = map});
  return edits;
}

class PosedMapBuilder {
 public:
  PosedMapBuilder(SessionId session, const PosedMapOptions& options)
      : options_(options), map_{session, 1}, next_keyframe_{session, 1}, next_landmark_{session, 1} {}

  void Insert(const PosedKeyframe& keyframe) {
    const KeyframeId id = Add(keyframe);
    const std::vector<KeyframeId> neighbours = NeighboursOf(id);
    Do(SearchLandmarks(atlas_, Get(id), LandmarksSeenBy(atlas_, neighbours), options_.search));
    Create(CreateFromStereo(atlas_, Get(id), next_landmark_, options_.creation));
    Create(CreateByTriangulation(atlas_, Get(id), neighbours, next_landmark_, options_.creation, options_.noise));
    for (const KeyframeId neighbour : neighbours) {
      // Anew for each: an earlier fusion may have replaced a landmark.
      Do(SearchLandmarks(atlas_, Get(neighbour), LandmarksSeenBy(atlas_, {id}), options_.search));
    }
  }

  PosedMap Finish() {
    const WindowBundle bundle = BuildWindowBundle(atlas_, Everything(), options_.noise);
    BundleOptions solver;
    solver.solver = BundleSolver::kSparse;
    solver.iterations = options_.iterations;
    solver.iterations_without_outliers = options_.iterations_without_outliers;
    double median = 0.0;
    if (!bundle.problem.observations.empty()) {
      const auto result = SolveBundle(bundle.problem, solver);
      PANGAEA_CHECK(result.has_value());
      median = MedianError(bundle.problem, *result);
      std::vector<std::pair<LandmarkId, Eigen::Vector3d>> points;
      for (std::size_t i = 0; i < bundle.landmarks.size(); ++i) {
        points.emplace_back(bundle.landmarks[i], result->points[i]);
      }
      Do({MoveLandmarksTo(atlas_, points)});
      Do(RemoveOutliers(atlas_, bundle, result->outliers));
    }
    return {ShortestEdits(atlas_, map_), median};
  }

 private:
  const Keyframe& Get(KeyframeId id) const { return *atlas_.FindKeyframe(id); }

  // Below the keyframe that looks most nearly at the same.
  KeyframeId Add(const PosedKeyframe& keyframe) {
    const KeyframeId id{next_keyframe_.session, next_keyframe_.counter++};
    if (id.counter == 1) map_from_world_ = keyframe.world_from_camera.Inverse();
    const Rigid3d camera_from_map = (map_from_world_ * keyframe.world_from_camera).Inverse();
    const std::vector<KeyframeId> near = Overlapping(keyframe.data->camera, camera_from_map, id);
    const KeyframeId parent = !near.empty()    ? near.front()
                              : id.counter > 1 ? KeyframeId{id.session, id.counter - 1}
                                               : KeyframeId{};
    const Rigid3d parent_from_map = parent.valid() ? Get(parent).camera_from_map : Rigid3d();
    Do({AddKeyframe{.id = id,
                    .map = map_,
                    .parent = parent,
                    .camera_from_parent = camera_from_map * parent_from_map.Inverse(),
                    .data = keyframe.data}});
    return id;
  }

  std::vector<KeyframeId> Overlapping(const IdealCamera& camera, const Rigid3d& camera_from_map,
                                      KeyframeId self) const {
    const Viewpoint viewpoint(camera, camera_from_map);
    std::vector<std::pair<double, KeyframeId>> ranked;
    atlas_.ForEachKeyframe([&](const Keyframe& other) {
      if (other.id == self) return;
      const double share = VisibleShare(atlas_, other, viewpoint, options_.overlap_samples);
      if (share >= options_.min_overlap) ranked.emplace_back(-share, other.id);
    });
    std::sort(ranked.begin(), ranked.end());
    if (ranked.size() > options_.creation.neighbours) ranked.resize(options_.creation.neighbours);
    std::vector<KeyframeId> result;
    for (const auto& [share, id] : ranked) result.push_back(id);
    return result;
  }

  std::vector<KeyframeId> NeighboursOf(KeyframeId id) const {
    std::vector<KeyframeId> result = Overlapping(Get(id).data->camera, Get(id).camera_from_map, id);
    for (std::uint32_t back = 1; back <= options_.latest && back < id.counter; ++back) {
      const KeyframeId previous{id.session, id.counter - back};
      if (std::find(result.begin(), result.end(), previous) == result.end()) result.push_back(previous);
    }
    return result;
  }

  BundleWindow Everything() const {
    BundleWindow window;
    atlas_.ForEachKeyframe([&](const Keyframe& keyframe) { window.fixed.push_back(keyframe.id); });
    atlas_.ForEachLandmark([&](const Landmark& landmark) { window.landmarks.push_back(landmark.id); });
    return window;
  }

  // Of points that several keyframes see: one alone agrees with itself.
  static double MedianError(const BundleProblem& problem, const BundleResult& result) {
    std::vector<int> views(problem.points.size());
    for (const BundleObservation& observation : problem.observations)
      ++views[static_cast<std::size_t>(observation.point)];
    std::vector<double> errors;
    for (std::size_t i = 0; i < problem.observations.size(); ++i) {
      const BundleObservation& observation = problem.observations[i];
      if (result.outliers[i] != 0 || views[static_cast<std::size_t>(observation.point)] < 2) continue;
      const BundlePose& pose = problem.poses[static_cast<std::size_t>(observation.pose)];
      const Eigen::Vector3d point = pose.camera_from_map * result.points[static_cast<std::size_t>(observation.point)];
      const IdealCamera& camera = problem.cameras[static_cast<std::size_t>(pose.camera)];
      errors.push_back(observation.inverse_sigma *
                       ReprojectionError(camera, point, observation.measurement).head<2>().norm());
    }
    return Median(std::move(errors));
  }

  void Create(std::vector<MapEdit> edits) {
    for (const MapEdit& edit : edits) next_landmark_.counter += std::holds_alternative<AddLandmark>(edit) ? 1 : 0;
    Do(edits);
  }

  void Do(const std::vector<MapEdit>& edits) {
    // Our own edits fit our own atlas; anything else is a bug of this file.
    for (const MapEdit& edit : edits) PANGAEA_CHECK(Apply(edit, atlas_).has_value());
  }

  const PosedMapOptions& options_;
  const MapId map_;
  Rigid3d map_from_world_;
  KeyframeId next_keyframe_;
  LandmarkId next_landmark_;
  Atlas atlas_;
};

}  // namespace

Status PosedMapOptions::Check() const {
  RangeCheck check("map of posed keyframes");
  check.In("min_overlap", min_overlap, 0.01, 1)
      .In("overlap_samples", overlap_samples, 1, 10000)
      .In("latest", latest, 1, 1000)
      .In("iterations", iterations, 1, 1000)
      .In("iterations_without_outliers", iterations_without_outliers, 0, 1000);
  return check.status();
}

PosedMap BuildPosedMap(SessionId session, std::span<const PosedKeyframe> keyframes, const PosedMapOptions& options) {
  PANGAEA_CHECK(!keyframes.empty());
  PosedMapBuilder builder(session, options);
  for (const PosedKeyframe& keyframe : keyframes) builder.Insert(keyframe);
  return builder.Finish();
}

}  // namespace pangaea
