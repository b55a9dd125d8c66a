#include "agent/mapping/local_mapper.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "agent/absorption/absorption.h"
#include "agent/mapping/guest_rules.h"
#include "agent/mapping/keyframe_culling.h"
#include "agent/mapping/keyframe_insertion.h"
#include "agent/mapping/map_strain.h"
#include "agent/mapping/neighbourhood.h"
#include "agent/mapping/vergence_check.h"
#include "common/base/check.h"
#include "common/map/covisibility.h"
#include "common/map/keyframe_vergence.h"
#include "common/map/map_edit.h"
#include "common/map/spanning_tree.h"
#include "common/mapping/landmark_creation.h"
#include "common/mapping/landmark_search.h"

namespace pangaea {
namespace {

// Of two values on the same side of the present one the nearer; none where they are not, or one is missing.
std::optional<double> SmallerChange(double present, std::optional<double> first, std::optional<double> second) {
  if (!first || !second || std::signbit(*first - present) != std::signbit(*second - present)) return std::nullopt;
  return std::abs(*first - present) < std::abs(*second - present) ? first : second;
}

}  // namespace

LocalMapper::LocalMapper(SessionId session, LocalMappingOptions options)
    : session_(session), options_(options), trials_(options.landmark_culling) {}

bool LocalMapper::Insert(const KeyframeCandidate& candidate, StageRecorder& stages, std::stop_token stop) {
  {
    const StageScope stage(stages, "mapping.insert");
    KeyframeCandidate corrected = candidate;
    corrected.data = WithVergence(candidate.data, vergence_);
    std::vector<MapEdit> edits = InsertKeyframe(atlas_, corrected, options_.noise);
    if (edits.empty()) return false;
    Commit(std::move(edits));
  }
  {
    const StageScope stage(stages, "mapping.cull_landmarks");
    Commit(trials_.Judge(atlas_));
  }
  {
    const StageScope stage(stages, "mapping.search");
    SearchOldLandmarks(candidate.id);
  }
  {
    const StageScope stage(stages, "mapping.create");
    CreateLandmarks(candidate.id);
  }
  {
    const StageScope stage(stages, "mapping.fuse");
    FuseIntoNeighbours(candidate.id, stop);
  }
  trials_.CountChances(atlas_, *atlas_.FindKeyframe(candidate.id), options_.search.max_view_angle);
  if (stop.stop_requested()) return true;
  AdjustAround(candidate.id, stages, stop);
  if (IsVergenceDue(candidate.id)) CorrectVergence(candidate.id, stages, stop);
  {
    const StageScope stage(stages, "mapping.cull_keyframes");
    CullKeyframes(candidate.id, candidate.reference);
  }
  return true;
}

bool LocalMapper::Open(const MapOpening& opening, StageRecorder& stages) {
  {
    const StageScope stage(stages, "mapping.insert");
    std::vector<MapEdit> edits = OpenMap(atlas_, opening, NextLandmark());
    if (edits.empty()) return false;
    CommitCreated(std::move(edits));
  }
  {
    const StageScope stage(stages, "mapping.create");
    CreateLandmarks(opening.second.id);
  }
  const StageScope stage(stages, "mapping.bundle_adjustment");
  AdjustBundle(opening.second.id, {});
  return true;
}

void LocalMapper::AddFrames(std::span<const TrackedFrame> frames) {
  AddFramePoses edit;
  std::int64_t newest_stamp = std::numeric_limits<std::int64_t>::min();
  for (const TrackedFrame& frame : frames) {
    if (!atlas_.Knows(frame.reference) || frame.pose.stamp_ns <= newest_stamp) continue;
    newest_stamp = frame.pose.stamp_ns;
    edit.frames.push_back(frame);
  }
  if (!edit.frames.empty()) Commit(std::move(edit));
}

void LocalMapper::CloseMap(MapId map) {
  const MapInfo* info = atlas_.FindMap(atlas_.Resolve(map));
  if (info == nullptr || info->closed) return;
  Commit(pangaea::CloseMap{.map = info->id});
  trials_ = LandmarkTrials(options_.landmark_culling);
}

void LocalMapper::Absorb(const AgentCorrection& correction, const Atlas& base) {
  const AbsorptionInput input{session_, correction.version, base, correction.pieces, correction.complete};
  Absorption absorption = PlanAbsorption(atlas_, input);
  atlas_ = std::move(absorption.after);
  std::move(absorption.edits.begin(), absorption.edits.end(), std::back_inserter(pending_edits_));
}

std::vector<ForgottenKeyframe> LocalMapper::Forget(std::span<const KeyframeId> keyframes) {
  std::vector<ForgottenKeyframe> forgotten;
  for (const KeyframeId id : keyframes) {
    const Keyframe* keyframe = atlas_.FindKeyframe(id);
    if (keyframe != nullptr && !IsForgotten(*keyframe)) forgotten.push_back({id, keyframe->frames});
  }
  pangaea::Forget(atlas_, forgotten);
  return forgotten;
}

void LocalMapper::Adopt(std::span<const MapEdit> edits) {
  for (const MapEdit& edit : edits) PANGAEA_CHECK(Apply(edit, atlas_).has_value());
}

std::vector<MapEdit> LocalMapper::TakeEdits() { return std::exchange(pending_edits_, {}); }

void LocalMapper::SearchOldLandmarks(KeyframeId newest) {
  const Keyframe& keyframe = *atlas_.FindKeyframe(newest);
  const std::vector<KeyframeId> neighbours = Neighbourhood(atlas_, keyframe, options_.neighbourhood);
  Commit(RespectOthers(atlas_, session_,
                       SearchLandmarks(atlas_, keyframe, LandmarksSeenBy(atlas_, neighbours), options_.search)));
}

void LocalMapper::CreateLandmarks(KeyframeId newest) {
  CommitCreated(CreateFromStereo(atlas_, *atlas_.FindKeyframe(newest), NextLandmark(), options_.creation));
  const Keyframe& keyframe = *atlas_.FindKeyframe(newest);
  std::vector<KeyframeId> neighbours = BestCovisible(keyframe, options_.creation.neighbours);
  // A guest's keypoints are not for this agent to give landmarks to.
  std::erase_if(neighbours, [this](KeyframeId id) { return id.session != session_; });
  if (neighbours.empty() && keyframe.parent.session == session_) neighbours.push_back(keyframe.parent);
  CommitCreated(CreateByTriangulation(atlas_, keyframe, neighbours, NextLandmark(), options_.creation, options_.noise));
}

void LocalMapper::FuseIntoNeighbours(KeyframeId newest, const std::stop_token& stop) {
  for (const KeyframeId neighbour : BestCovisible(*atlas_.FindKeyframe(newest), options_.fused_keyframes)) {
    if (stop.stop_requested()) return;
    // Anew for each: an earlier fusion may have replaced a landmark.
    const std::vector<LandmarkId> wanted = LandmarksSeenBy(atlas_, {newest});
    Commit(RespectOthers(atlas_, session_,
                         SearchLandmarks(atlas_, *atlas_.FindKeyframe(neighbour), wanted, options_.search)));
  }
}

std::vector<LandmarkId> LocalMapper::AdjustBundle(KeyframeId newest, std::stop_token stop) {
  AdjustmentWindow window = ChooseAdjustmentWindow(atlas_, newest, options_.bundle_adjustment);
  if (window.free.empty()) return {};
  CommitAdjustment(AdjustLocalMap(atlas_, window, options_.bundle_adjustment, options_.noise, std::move(stop)));
  return std::move(window.landmarks);
}

void LocalMapper::AdjustAround(KeyframeId newest, StageRecorder& stages, const std::stop_token& stop) {
  std::vector<LandmarkId> adjusted;
  {
    const StageScope stage(stages, "mapping.bundle_adjustment");
    adjusted = AdjustBundle(newest, stop);
  }
  if (!stop.stop_requested() && NeedsWideAdjustment(newest, adjusted)) AdjustWidely(newest, stages, stop);
}

bool LocalMapper::NeedsWideAdjustment(KeyframeId newest, std::span<const LandmarkId> landmarks) const {
  const WideAdjustmentOptions& options = options_.wide_adjustment;
  const double wanted_gap = std::max<double>(options.min_gap, options.min_growth * adjusted_widely_at_);
  if (!options.enabled || newest.counter < adjusted_widely_at_ + wanted_gap) return false;
  return StrainOf(atlas_, landmarks, options.strain_samples, options_.noise).share() > options.max_strain;
}

void LocalMapper::AdjustBeforeClosing(MapId map, StageRecorder& stages, const std::stop_token& stop) {
  if (!options_.wide_adjustment.enabled || options_.wide_adjustment.max_strain >= 1.0) return;
  const std::vector<KeyframeId> keyframes = ParentsFirst(atlas_, atlas_.Resolve(map));
  const auto newest = std::max_element(keyframes.begin(), keyframes.end());
  if (newest == keyframes.end()) return;
  if (!CorrectVergence(*newest, stages, stop)) AdjustWidely(*newest, stages, stop);
}

void LocalMapper::AdjustWidely(KeyframeId newest, StageRecorder& stages, const std::stop_token& stop) {
  const StageScope stage(stages, "mapping.wide_adjustment");
  const WideAdjustmentOptions& options = options_.wide_adjustment;
  const AdjustmentWindow window = ChooseAdjustmentWindow(atlas_, newest, options.bundle_adjustment);
  LocalAdjustment adjustment = AdjustLocalMap(atlas_, window, options.bundle_adjustment, options_.noise, stop);
  if (stop.stop_requested()) return;  // half of an adjustment cannot be judged
  adjusted_widely_at_ = newest.counter;
  if (adjustment.outlier_share <= options.max_outliers) CommitAdjustment(std::move(adjustment));
}

bool LocalMapper::IsVergenceDue(KeyframeId newest) const {
  const VergenceOptions& options = options_.vergence;
  if (suspected_vergence_) return newest.counter >= vergence_checked_at_ + options.second_look_keyframes;
  return newest.counter >= std::max(options.first_keyframes, 2 * vergence_checked_at_);
}

bool LocalMapper::IsSure(std::optional<double> better, double focal_x) const {
  return better && std::abs(*better - vergence_) * focal_x >= options_.vergence.min_sure_shift;
}

bool LocalMapper::CorrectVergence(KeyframeId newest, StageRecorder& stages, const std::stop_token& stop) {
  if (stop.stop_requested()) return false;
  // A look a moment after the last one, as a map is closed, sees the same once more.
  const bool another_look = newest.counter >= vergence_checked_at_ + options_.vergence.second_look_keyframes / 2;
  if (suspected_vergence_ && !another_look) return false;
  VergenceFinding finding;
  {
    const StageScope stage(stages, "mapping.vergence");
    finding = FindBetterVergence(atlas_, newest, options_.vergence, options_.noise, stop);
  }
  if (stop.stop_requested()) return false;
  vergence_checked_at_ = std::max(vergence_checked_at_, newest.counter);
  if (!finding.could_tell) return false;
  const double focal_x = atlas_.FindKeyframe(newest)->data->camera.focal_x;
  const auto believed =
      IsSure(finding.better, focal_x) ? finding.better : SmallerChange(vergence_, suspected_vergence_, finding.better);
  suspected_vergence_ = believed ? std::nullopt : finding.better;
  if (!believed) return false;
  vergence_ = *believed;
  Commit(SetVergence{session_, vergence_});
  AdjustWidely(newest, stages, stop);
  return true;
}

void LocalMapper::CommitAdjustment(LocalAdjustment adjustment) {
  if (adjustment.camera_from_map.empty()) return;
  Commit(MoveKeyframesTo(atlas_, adjustment.camera_from_map));
  Commit(MoveLandmarksTo(atlas_, adjustment.point_in_map));
  Commit(std::move(adjustment.removals));
}

void LocalMapper::CullKeyframes(KeyframeId newest, KeyframeId reference) {
  const std::vector<KeyframeId> kept{atlas_.Resolve(reference)};
  while (const auto redundant =
             FindRedundantKeyframe(atlas_, *atlas_.FindKeyframe(newest), kept, options_.creation.close_depth_baselines,
                                   options_.keyframe_culling)) {
    Commit(RemoveKeyframe{.id = *redundant});
  }
}

void LocalMapper::Commit(MapEdit edit) {
  // Our own edits fit our own atlas; anything else is a bug of local mapping.
  PANGAEA_CHECK(Apply(edit, atlas_).has_value());
  pending_edits_.push_back(std::move(edit));
}

void LocalMapper::Commit(std::vector<MapEdit> edits) {
  for (MapEdit& edit : edits) Commit(std::move(edit));
}

void LocalMapper::CommitCreated(std::vector<MapEdit> edits) {
  for (const MapEdit& edit : edits) landmarks_created_ += std::holds_alternative<AddLandmark>(edit) ? 1 : 0;
  trials_.Begin(edits);
  Commit(std::move(edits));
}

}  // namespace pangaea
