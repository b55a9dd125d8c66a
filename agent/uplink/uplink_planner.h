#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

struct UplinkPlannerOptions {
  // A keyframe this old (by image stamps) is settled whatever happens: place recognition would starve without it.
  double max_unsettled_seconds = 5.0;
  // The newest keyframes are never settled before that age: local mapping still triangulates with them.
  int window_keyframes = 3;
  // An older keyframe that shares at least this many landmarks with the newest is still in the local window.
  int window_covisibility = 15;
  // A keyframe that moved less than both is not sent again before the flush: below what the images can tell.
  double keyframe_move_m = 0.001;
  double keyframe_turn_deg = 0.05;
  // A landmark that moved less than the larger of both is not sent again before the flush. The fraction is of its
  // distance to its reference keyframe: 0.002 is about a pixel's width at a focal length of 450 pixels.
  double landmark_move_m = 0.001;
  double landmark_move_fraction = 0.002;

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
  // rounding of a boundary of the digest's grid, so that both sides quantise them alike. `edits` hold the same.
  std::vector<MapEdit> own_edits;
};

// Turns the agent's map into edits relative to what the server already has. It keeps a mirror, which is exactly the
// server's atlas once the server has applied everything planned so far. Not thread-safe; owned by the uplink thread.
// Agents do not merge maps themselves: an own MergeMaps is not planned.
class UplinkPlanner {
 public:
  explicit UplinkPlanner(const UplinkPlannerOptions& options) : options_(options) {}

  // `snapshot` is the agent's atlas after `applied_since`, the edits applied to it since the previous call's snapshot.
  UplinkPlan Plan(const Atlas& snapshot, std::span<const MapEdit> applied_since, PlanKind kind);

  const Atlas& mirror() const { return mirror_; }

 private:
  UplinkPlannerOptions options_;
  Atlas mirror_;
};

}  // namespace pangaea
