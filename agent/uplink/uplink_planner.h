#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "agent/uplink/mirror_update.h"
#include "agent/uplink/settling.h"
#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "common/map/forgetting.h"

namespace pangaea {

struct UplinkPlannerOptions {
  SettlingOptions settling;
  // A keyframe that moved less than both is not sent again before the flush: below what the images can tell.
  double keyframe_move_m = 0.001;
  double keyframe_turn_deg = 0.05;
  // A landmark that moved less than the larger of both is not sent again before the flush. The fraction is of its
  // distance to its reference keyframe: 0.002 is about a pixel at a focal length of 450 pixels.
  double landmark_move_m = 0.001;
  double landmark_move_fraction = 0.002;
  // A new landmark with fewer observations is not sent before the flush: half of what one keyframe alone sees fails its
  // trial (LandmarkTrials) a few keyframes later.
  std::uint32_t min_observations = 2;

  Status Check() const;
};

enum class PlanKind {
  kOngoing,  // what is settled, and what changed beyond the thresholds
  kFlush,    // everything: afterwards the server's atlas equals the agent's
};

// What the uplink wants done.
struct UplinkPlan {
  std::vector<MapEdit> edits;  // for the server, in order
  // For the agent's own atlas, after a flush alone and then nearly always empty: moves numbers that lie within
  // rounding of a boundary of the digest's grid, so that both sides quantise them alike. `edits` do the same there.
  std::vector<MapEdit> own_edits;
};

// Turns the agent's map into edits relative to what the server already has. It keeps a mirror, which is exactly the
// server's atlas once the server has applied everything planned so far. Not thread-safe; owned by the uplink thread.
// Agents do not merge maps themselves: an own MergeMaps is not planned. Of guests (keyframes and landmarks of other
// sessions) only what the session's keyframes observe is; what a correction has placed is not moved. What a correction
// changes, the mirror has absorbed too (AdoptMirror) when the snapshot that absorbed it comes.
class UplinkPlanner {
 public:
  UplinkPlanner(const UplinkPlannerOptions& options, SessionId session) : options_(options), session_(session) {}

  // `snapshot` is the agent's atlas after `applied_since`, the edits applied to it since the previous call's snapshot,
  // and after it has forgotten `forgotten`, as the mirror does then.
  UplinkPlan Plan(const Atlas& snapshot, std::span<const MapEdit> applied_since, PlanKind kind,
                  std::span<const ForgottenKeyframe> forgotten = {});

  // The maps that the agent closed and the server has not. For when the server has taken everything else: a closed map
  // takes no more keyframes, not even those of a repair.
  std::vector<MapEdit> PlanClosing(const Atlas& snapshot);
  // Once for each: the session's maps that became part of others' are closed, too. To the map that changes nothing; the
  // server learns that it may adjust what there is.
  std::vector<MapEdit> PlanFarewell();
  // As far as Plan learns from it, without planning: the edits come with the next plan.
  void Note(const Atlas& snapshot, std::span<const MapEdit> applied_since);

  // See common/map/forgetting.h.
  void ShareFrames(const Atlas& snapshot) { pangaea::ShareFrames(mirror_, snapshot); }

  const Atlas& mirror() const { return mirror_; }
  // The server turned out to have this instead: envelopes were rejected, or a correction came. The next plan sends what
  // differs.
  void AdoptMirror(Atlas mirror);

 private:
  void Mark(const Atlas& snapshot, const MapEdit& edit);
  void MarkEverything(const Atlas& snapshot);
  void MarkLandmarksOf(const Atlas& snapshot, std::span<const KeyframeId> keyframes);
  std::vector<KeyframeId> UnsentObservers(const Atlas& snapshot, std::span<const ForgottenKeyframe> forgotten) const;
  std::vector<KeyframeId> Settled(const Atlas& snapshot, PlanKind kind) const;
  MoveThresholds Thresholds(PlanKind kind) const;

  bool IsOwn(KeyframeId id) const { return id.session == session_; }

  UplinkPlannerOptions options_;
  SessionId session_;
  Atlas mirror_;
  bool everything_is_new_ = false;
  bool vergence_is_new_ = false;
  std::int64_t newest_stamp_ns_ = 0;
  std::set<MapId> farewells_;  // planned
  // What the agent touched and the mirror may not have followed yet.
  std::set<KeyframeId> unsent_;
  std::set<KeyframeId> culled_;
  std::set<KeyframeId> moved_keyframes_;
  std::set<KeyframeId> keyframes_with_frames_;
  std::set<LandmarkId> landmarks_;
  std::set<LandmarkId> moved_landmarks_;
};

}  // namespace pangaea
