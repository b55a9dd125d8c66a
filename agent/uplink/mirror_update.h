#pragma once

#include <set>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

// From which difference on something is moved again.
struct MoveThresholds {
  double keyframe_m = 0.0;         // of the camera's centre
  double keyframe_rad = 0.0;       // of its orientation
  double landmark_m = 0.0;         // of the point; the larger of both counts
  double landmark_fraction = 0.0;  // of its distance to its reference keyframe
  bool digest_grid = false;        // also what Digest() would tell apart, however small
};

// One round of making a mirror of the agent's atlas follow it: finds what differs, and emits the edits that mend it,
// each valid where it stands. What it is not asked about stays as it is in the mirror. Keyframes not in the mirror do
// not exist for it: landmarks travel with those of their observations whose keyframes do. Only what is the session's is
// touched: of other sessions' landmarks the observations by its keyframes.
class MirrorUpdate {
 public:
  // A new landmark with fewer than `min_observations` waits until it has as many, unless the first keyframe of a map
  // sees it.
  MirrorUpdate(SessionId session, const Atlas& agent, Atlas& mirror, std::vector<MapEdit>& edits,
               std::size_t min_observations = 1)
      : session_(session), agent_(agent), mirror_(mirror), edits_(edits), min_observations_(min_observations) {}

  // These and their ancestors, parents first. Returns those that were not there before.
  std::vector<KeyframeId> AddKeyframes(const std::vector<KeyframeId>& keyframes);
  // Removes those the agent culled, children before parents. Returns the landmarks they observed: match them next.
  std::vector<LandmarkId> RemoveKeyframes(const std::set<KeyframeId>& culled);
  // Fusions, removals, new landmarks, observations, reference keyframes; positions of new ones alone. Erases what is
  // done from `landmarks`; what stays waits for its reference keyframe to be sent, or for more observations.
  void MatchLandmarks(std::set<LandmarkId>& landmarks);
  // The vergence of the session's rig. Keyframes that the mirror has not yet bring their own.
  void SetVergence();
  void MoveKeyframes(const std::set<KeyframeId>& keyframes, const MoveThresholds& thresholds);
  void MoveLandmarks(const std::set<LandmarkId>& landmarks, const MoveThresholds& thresholds);
  // The frames these keyframes hold, where they are new or differ by more than the thresholds for keyframes.
  void AddFrames(const std::set<KeyframeId>& keyframes, const MoveThresholds& thresholds);
  void AddLoopEdges();
  // But those that keyframes of `unsent` belong to.
  void CloseMaps(const std::set<KeyframeId>& unsent);

  // Applies one edit to the mirror and adds it to the others. False, and left out, where the mirror refuses it: an
  // absolute number was fine, but its relative form is beyond what an edit may carry.
  bool Emit(MapEdit edit);

 private:
  const Keyframe* ParentInMirror(const Keyframe& keyframe) const;
  bool MatchLandmark(LandmarkId id, std::set<LandmarkId>& landmarks);
  bool MatchGuest(const Landmark& wanted, std::set<LandmarkId>& landmarks);
  bool MatchVanished(LandmarkId id, std::set<LandmarkId>& landmarks);
  bool IsOnTrial(const Landmark& wanted) const;
  void RemoveWrongObservations(const Landmark& wanted);
  bool AddLandmarkItself(const Landmark& wanted, std::set<LandmarkId>& landmarks);
  void AddMissingObservations(const Landmark& wanted, std::set<LandmarkId>& landmarks);
  void FreeKeypoint(KeyframeId keyframe, std::uint32_t keypoint, LandmarkId wanted, std::set<LandmarkId>& landmarks);

  template <typename Tag>
  bool IsOwn(const Id<Tag>& id) const {
    return id.session == session_;
  }
  bool HasGuests(const Landmark& landmark) const;
  bool Shows(KeyframeId id) const;  // the mirror has it and what it saw

  SessionId session_;
  const Atlas& agent_;
  Atlas& mirror_;
  std::vector<MapEdit>& edits_;
  std::size_t min_observations_;
};

}  // namespace pangaea
