#include "server/fusion/duplicate_fusion.h"

#include <algorithm>
#include <iterator>

#include "common/map/covisibility.h"
#include "common/mapping/measurement_noise.h"

namespace pangaea {
namespace {

std::vector<KeyframeId> Nearest(const std::vector<KeyframeId>& side, std::size_t count) {
  return {side.begin(), side.begin() + static_cast<std::ptrdiff_t>(std::min(count, side.size()))};
}

}  // namespace

DuplicateFusion::DuplicateFusion(const std::vector<KeyframeId>& trusted, const LandmarkSearchOptions& options,
                                 WeldingDraft& draft)
    : trusted_(trusted.begin(), trusted.end()), options_(options), draft_(draft), atlas_(draft.welded()) {}

void DuplicateFusion::FusePairs(const std::vector<std::pair<LandmarkId, LandmarkId>>& pairs) {
  for (const auto& [a, b] : pairs) FuseIfOnePoint(atlas_.Resolve(a), atlas_.Resolve(b));
}

void DuplicateFusion::SearchIn(KeyframeId id, const std::vector<LandmarkId>& wanted) {
  const std::vector<LandmarkSighting> sightings = FindLandmarks(atlas_, *atlas_.FindKeyframe(id), wanted, options_);
  for (const LandmarkSighting& sighting : sightings) {
    const LandmarkId found = atlas_.Resolve(sighting.landmark);
    // As it is by now: an earlier sighting may have given the keypoint a landmark.
    const LandmarkId present = atlas_.FindKeyframe(id)->landmarks[sighting.keypoint];
    if (present.valid()) {
      FuseIfOnePoint(found, present);
    } else if (found.valid()) {
      ObserveIfOnePoint(found, {id, sighting.keypoint});
    }
  }
}

// The one with more observations is kept, of equals the older.
void DuplicateFusion::FuseIfOnePoint(LandmarkId a, LandmarkId b) {
  if (!a.valid() || !b.valid() || a == b) return;
  const std::size_t of_a = atlas_.FindLandmark(a)->observations.size();
  const std::size_t of_b = atlas_.FindLandmark(b)->observations.size();
  const bool keep_a = of_a != of_b ? of_a > of_b : a < b;
  const FuseLandmarks fusion{.kept = keep_a ? a : b, .absorbed = keep_a ? b : a};
  const auto point = CommonPoint(*atlas_.FindLandmark(fusion.kept), *atlas_.FindLandmark(fusion.absorbed));
  if (!point) return;
  draft_.Change(fusion);
  draft_.MovePoint(fusion.kept, *point);
}

void DuplicateFusion::ObserveIfOnePoint(LandmarkId id, const Observation& observation) {
  const Landmark& landmark = *atlas_.FindLandmark(id);
  std::vector<PointView> views;
  AddViews(landmark, views);
  views.push_back(ViewOf(observation));
  if (RefineWithinGate(views, landmark.point_in_map)) {
    draft_.Change(AddObservation{id, observation.keyframe, observation.keypoint});
  }
}

// Asking instead that the position of each explains the other would keep apart what the one side saw from near and the
// other, without knowing its depth, from far away.
std::optional<Eigen::Vector3d> DuplicateFusion::CommonPoint(const Landmark& kept, const Landmark& absorbed) const {
  if (SeenApart(atlas_, kept, absorbed)) return std::nullopt;
  std::vector<PointView> views;
  AddViews(kept, views);
  AddViews(absorbed, views);
  return RefineWithinGate(views, kept.point_in_map);
}

std::optional<Eigen::Vector3d> DuplicateFusion::RefineWithinGate(const std::vector<PointView>& views,
                                                                 const Eigen::Vector3d& initial) const {
  const auto refined = RefinePoint(views, initial);
  if (!refined || refined->worst_chi2 > options_.fusion_gate * options_.fusion_gate) return std::nullopt;
  return refined->point_in_map;
}

PointView DuplicateFusion::ViewOf(const Observation& observation) const {
  const Keyframe& keyframe = *atlas_.FindKeyframe(observation.keyframe);
  const Keypoint& keypoint = keyframe.data->features.keypoints[observation.keypoint];
  return {.camera = keyframe.data->camera,
          .camera_from_map = keyframe.camera_from_map,
          .measurement = MeasurementOf(keypoint),
          .inverse_sigma = 1.0 / OctaveSigma(keypoint.octave)};
}

void DuplicateFusion::AddViews(const Landmark& landmark, std::vector<PointView>& views) const {
  for (const Observation& observation : landmark.observations) {
    if (trusted_.empty() || trusted_.contains(observation.keyframe)) views.push_back(ViewOf(observation));
  }
}

void FuseAcrossSeam(const WeldingWindow& window, const std::vector<std::pair<LandmarkId, LandmarkId>>& pairs,
                    std::size_t searched, const LandmarkSearchOptions& options, WeldingDraft& draft) {
  std::vector<KeyframeId> trusted = window.kept;
  for (const auto* part : {&window.moved, &window.fixed}) trusted.insert(trusted.end(), part->begin(), part->end());
  DuplicateFusion fusion(trusted, options, draft);
  fusion.FusePairs(pairs);
  const std::vector<KeyframeId> kept = Nearest(window.kept, searched);
  const std::vector<KeyframeId> moved = Nearest(window.moved, searched);
  const std::vector<LandmarkId> of_moved = LandmarksSeenBy(draft.welded(), moved);
  for (const KeyframeId id : kept) fusion.SearchIn(id, of_moved);
  const std::vector<LandmarkId> of_kept = LandmarksSeenBy(draft.welded(), kept);
  for (const KeyframeId id : moved) fusion.SearchIn(id, of_kept);
}

std::vector<LandmarkId> CommonLandmarks(const Atlas& atlas, const WeldingWindow& window) {
  const LandmarkIdSet moved = LandmarkSetOf(atlas, window.moved);
  std::vector<LandmarkId> common = LandmarksSeenBy(atlas, window.kept);
  std::erase_if(common, [&moved](LandmarkId id) { return !moved.Contains(id); });
  return common;
}

}  // namespace pangaea
