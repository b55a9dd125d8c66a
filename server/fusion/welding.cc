#include "server/fusion/welding.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "common/map/covisibility.h"
#include "common/map/map_edit.h"
#include "server/fusion/duplicate_fusion.h"
#include "server/fusion/seam.h"
#include "server/fusion/seam_adjustment.h"
#include "server/fusion/welding_draft.h"
#include "server/fusion/welding_window.h"

namespace pangaea {
namespace {

LandmarkSearchOptions SearchWithin(const FusionOptions& options, double radius) {
  LandmarkSearchOptions search = options.search;
  search.radius = radius;
  search.old_radius = radius;
  search.fusion_gate = radius;
  return search;
}

// The work on one seam, step by step in the order of the paper's section "Seamless map merging".
class Welding {
 public:
  Welding(const Atlas& snapshot, const Seam& seam, const FusionOptions& options, std::stop_token stop)
      : snapshot_(snapshot),
        seam_(seam),
        options_(options),
        stop_(std::move(stop)),
        window_(GrowWeldingWindow(snapshot, seam, options.window)),
        draft_(snapshot) {}

  WeldingOutcome Run(const PlaceEvidence& match) {
    evidence_.match = match;
    evidence_.window_keyframes = window_.kept.size() + window_.moved.size();
    evidence_.scale = seam_.kept_from_moved.scale();
    if (!seam_.is_merge()) {
      evidence_.drift = MeasureDrift(snapshot_, seam_, options_.drift);
      if (!evidence_.drift.is_plausible()) return Refuse(WeldingRefusalReason::kContradiction);
    }
    evidence_.before = SidesByThemselves();
    Align();
    if (stop_.stop_requested()) return Refuse(WeldingRefusalReason::kCancelled);
    Fuse(options_.first_radius);
    evidence_.common_landmarks = CommonLandmarks(draft_.welded(), window_).size();
    if (evidence_.common_landmarks < options_.judgement.min_common_landmarks) {
      return Refuse(WeldingRefusalReason::kTooFewCommonLandmarks);
    }
    const auto adjustment = AdjustSeam(draft_.welded(), window_, options_, stop_);
    if (!adjustment) return Refuse(WeldingRefusalReason::kCancelled);
    if (const auto reason = Judge(*adjustment)) return Refuse(*reason);
    TakeAdjustment(*adjustment, draft_);
    Fuse(options_.second_radius);
    if (stop_.stop_requested()) return Refuse(WeldingRefusalReason::kCancelled);
    return Finish();
  }

 private:
  WeldingOutcome Refuse(WeldingRefusalReason reason) const {
    return tl::make_unexpected(WeldingRefusal{reason, evidence_});
  }

  SeamResidual SidesByThemselves() const {
    std::vector<KeyframeId> kept = window_.kept;
    for (const KeyframeId id : window_.fixed) {
      if (std::find(kept.begin(), kept.end(), id) == kept.end()) kept.push_back(id);
    }
    SeamResidual residual = MeasureResidual(snapshot_, kept, options_.noise);
    return residual += MeasureResidual(snapshot_, window_.moved, options_.noise);
  }

  void Align() {
    if (seam_.is_merge()) {
      return draft_.Merge(MergeMaps{.survivor = seam_.kept_map,
                                    .absorbed = seam_.moved_map,
                                    .survivor_from_absorbed = seam_.kept_from_moved,
                                    .absorbed_attachment = seam_.moved,
                                    .survivor_attachment = seam_.kept});
    }
    // What the kept side sees as well holds both together already and stays.
    std::vector<LandmarkId> landmarks = LandmarksSeenBy(snapshot_, window_.moved);
    const LandmarkIdSet of_kept = LandmarkSetOf(snapshot_, window_.kept);
    std::erase_if(landmarks, [&of_kept](LandmarkId id) { return of_kept.Contains(id); });
    draft_.Transform(window_.moved, landmarks, seam_.kept_from_moved);
  }

  void Fuse(double radius) {
    FuseAcrossSeam(window_, seam_.landmarks, options_.window.searched, SearchWithin(options_, radius), draft_);
  }

  std::optional<WeldingRefusalReason> Judge(const SeamAdjustment& adjustment) {
    evidence_.after = MeasureResidual(adjustment.bundle, adjustment.bundle.landmarks);
    evidence_.common = MeasureResidual(adjustment.bundle, CommonLandmarks(draft_.welded(), window_));
    const SeamJudgementOptions& limits = options_.judgement;
    if (evidence_.common.inlier_share() < limits.min_inlier_share) return WeldingRefusalReason::kSidesDisagree;
    const double allowed = std::max(limits.noise_cost, limits.max_cost_growth * evidence_.before.mean_cost());
    if (evidence_.after.mean_cost() > allowed) return WeldingRefusalReason::kResidualGrew;
    return std::nullopt;
  }

  std::map<KeyframeId, double> Held(const Correction& correction) const {
    std::map<KeyframeId, double> held;
    for (const KeyframeId id : window_.fixed) held.emplace(id, 1.0);
    for (const CorrectedKeyframe& keyframe : correction.keyframes) held.emplace(keyframe.id, keyframe.scale);
    return held;
  }

  WeldingOutcome Finish() {
    const Keyframe& kept = *draft_.welded().FindKeyframe(seam_.kept);
    const Keyframe& moved = *draft_.welded().FindKeyframe(seam_.moved);
    draft_.Change(AddLoopEdge{.from = moved.id,
                              .to = kept.id,
                              .to_from_from = Similarity3d(kept.camera_from_map * moved.camera_from_map.Inverse())});
    for (const MapEdit& edit : draft_.edits()) {
      evidence_.fused += std::holds_alternative<FuseLandmarks>(edit) ? 1 : 0;
      evidence_.added += std::holds_alternative<AddObservation>(edit) ? 1 : 0;
      evidence_.removed += std::holds_alternative<RemoveObservation>(edit) ? 1 : 0;
    }
    Correction correction = draft_.Moves(seam_.kept_map);
    return WeldingPlan{.kept = seam_.kept,
                       .moved = seam_.moved,
                       .map = seam_.kept_map,
                       .absorbed = seam_.is_merge() ? seam_.moved_map : MapId{},
                       .edits = draft_.edits(),
                       .correction = correction,
                       .after_seam = draft_.welded(),
                       .held = Held(correction),
                       .evidence = evidence_};
  }

  const Atlas& snapshot_;
  const Seam& seam_;
  const FusionOptions& options_;
  std::stop_token stop_;
  const WeldingWindow window_;
  WeldingDraft draft_;
  WeldingEvidence evidence_;
};

}  // namespace

WeldingOutcome PlanWelding(const Atlas& snapshot, const PlaceMatch& match, const FusionOptions& options,
                           std::stop_token stop) {
  const auto seam = FindSeam(snapshot, match);
  if (!seam) {
    WeldingRefusal refusal;
    refusal.evidence.match = match.evidence;
    return tl::make_unexpected(refusal);
  }
  return Welding(snapshot, *seam, options, std::move(stop)).Run(match.evidence);
}

std::vector<MapEdit> ApplyTolerantly(std::span<const MapEdit> edits, Atlas& atlas) {
  std::vector<MapEdit> applied;
  for (const MapEdit& edit : edits) {
    if (Apply(edit, atlas)) {
      applied.push_back(edit);
    } else if (std::holds_alternative<MergeMaps>(edit)) {
      break;  // all that follows rests on it
    }
  }
  return applied;
}

}  // namespace pangaea
