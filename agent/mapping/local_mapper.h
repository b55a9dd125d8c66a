#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "agent/mapping/keyframe_candidate.h"
#include "agent/mapping/landmark_culling.h"
#include "agent/mapping/local_bundle_adjustment.h"
#include "agent/mapping/local_mapping_options.h"
#include "agent/mapping/map_opening.h"
#include "common/base/stage_recorder.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "common/map/forgetting.h"
#include "common/map/ids.h"
#include "common/wire/agent_correction.h"

namespace pangaea {

// Local mapping as in Mur-Artal and Tardos (2015, section VI; 2017, section III-D): what one new keyframe causes in the
// agent's map. Owns the agent's Atlas; belongs to one thread. Every step is a function from the atlas to edits in a
// file of its own; this class orders the steps and applies the edits.
class LocalMapper {
 public:
  // `options` have passed Check().
  LocalMapper(SessionId session, LocalMappingOptions options);

  // Everything that one keyframe causes. Stages: "mapping.insert", "mapping.cull_landmarks", "mapping.search",
  // "mapping.create", "mapping.fuse", "mapping.bundle_adjustment", "mapping.cull_keyframes"; where the camera came back
  // to an old place, now and then "mapping.wide_adjustment" after the bundle adjustment; with two cameras, when there
  // are twice as many keyframes as last time or what was found then waits for an answer, "mapping.vergence". When
  // `stop` is requested (a newer keyframe waits), fusion, bundle adjustments and keyframe culling are left out or cut
  // short; the map is consistent all the same. False, and nothing done, for a candidate that cannot enter the map: its
  // map is closed, its id is in use, or its reference is unknown.
  bool Insert(const KeyframeCandidate& candidate, StageRecorder& stages, std::stop_token stop = {});
  // The same for the beginning of a monocular map.
  bool Open(const MapOpening& opening, StageRecorder& stages);
  // Poses of ordinary frames. Those of a culled reference hang below its living ancestor; those of an unknown reference
  // or out of order are left out.
  void AddFrames(std::span<const TrackedFrame> frames);
  // All of the map that a wide adjustment reaches, once more, where such adjustments are enabled: a way that never came
  // back has had none, and the latest was made for a smaller map. Before CloseMap. Nothing happens to an unknown map,
  // nor where `stop` is requested before the end.
  void AdjustBeforeClosing(MapId map, StageRecorder& stages, const std::stop_token& stop = {});
  // No further keyframes. Landmarks on trial stay as they are. Nothing happens to an unknown map.
  void CloseMap(MapId map);

  // Takes in what the server says (PlanAbsorption).
  void Absorb(const AgentCorrection& correction, const Atlas& base);
  // Forgets what the keyframes saw (common/map/forgetting.h); returns those that it has forgotten by that.
  std::vector<ForgottenKeyframe> Forget(std::span<const KeyframeId> keyframes);
  // What the uplink asks for (UplinkPlan::own_edits): not among the edits that TakeEdits returns.
  void Adopt(std::span<const MapEdit> edits);

  const Atlas& atlas() const { return atlas_; }
  // By how much the rig turned out to differ from its calibration, radians (common/geometry/vergence.h).
  double vergence() const { return vergence_; }
  // All edits applied since the last call, in order.
  std::vector<MapEdit> TakeEdits();

 private:
  void SearchOldLandmarks(KeyframeId newest);
  void CreateLandmarks(KeyframeId newest);
  void FuseIntoNeighbours(KeyframeId newest, const std::stop_token& stop);
  // Returns the landmarks of the window.
  std::vector<LandmarkId> AdjustBundle(KeyframeId newest, std::stop_token stop);
  void AdjustAround(KeyframeId newest, StageRecorder& stages, const std::stop_token& stop);
  // Whether the map is strained at these landmarks, and the latest wide adjustment far enough back.
  bool NeedsWideAdjustment(KeyframeId newest, std::span<const LandmarkId> landmarks) const;
  void AdjustWidely(KeyframeId newest, StageRecorder& stages, const std::stop_token& stop);
  void CommitAdjustment(LocalAdjustment adjustment);
  bool IsVergenceDue(KeyframeId newest) const;
  // Whether the vergence that was found is so far from the present one that one look is enough.
  bool IsSure(std::optional<double> better, double focal_x) const;
  // A check. Returns whether the rig turned out to have another vergence than its keyframes: now they have it, and the
  // map is adjusted to it.
  bool CorrectVergence(KeyframeId newest, StageRecorder& stages, const std::stop_token& stop);
  void CullKeyframes(KeyframeId newest, KeyframeId reference);
  // By which local mapping changes the atlas; Absorb takes over what its edits lead to.
  void Commit(MapEdit edit);
  void Commit(std::vector<MapEdit> edits);
  void CommitCreated(std::vector<MapEdit> edits);
  LandmarkId NextLandmark() const { return {session_, landmarks_created_ + 1}; }

  SessionId session_;
  LocalMappingOptions options_;
  Atlas atlas_;
  std::vector<MapEdit> pending_edits_;
  LandmarkTrials trials_;
  std::uint32_t landmarks_created_ = 0;
  std::uint32_t adjusted_widely_at_ = 0;   // counter of the newest keyframe at the latest wide adjustment
  double vergence_ = 0.0;                  // radians, from the calibration; of all keyframes of the session
  std::uint32_t vergence_checked_at_ = 0;  // counter of the newest keyframe then; 0: never
  // What the last check found better and was not sure of: it is believed when the next one finds a change to the same
  // side (docs/decisions/0024-vergence.md). Kept across maps: the rig is one.
  std::optional<double> suspected_vergence_;
};

}  // namespace pangaea
