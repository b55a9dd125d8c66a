#pragma once

#include <Eigen/Core>
#include <optional>
#include <unordered_set>
#include <utility>
#include <vector>

#include "common/geometry/triangulation.h"
#include "common/mapping/landmark_search.h"
#include "server/fusion/welding_draft.h"
#include "server/fusion/welding_window.h"

namespace pangaea {

// Makes one landmark of several that are one point. Two are fused where they agree geometrically: one point lies within
// options.fusion_gate octave pixels of wherever keyframes saw them. It becomes the position.
class DuplicateFusion {
 public:
  // Only the views of `trusted` keyframes count in that; of all where it is empty. Changes the draft, which has to
  // outlive this.
  DuplicateFusion(const std::vector<KeyframeId>& trusted, const LandmarkSearchOptions& options, WeldingDraft& draft);

  // Pairs that are known to show the same.
  void FusePairs(const std::vector<std::pair<LandmarkId, LandmarkId>>& pairs);
  // Looks for landmarks in a keyframe: new observations, and duplicates that become one. Those that are gone, perhaps
  // fused by an earlier search, are passed over.
  void SearchIn(KeyframeId id, const std::vector<LandmarkId>& wanted);

 private:
  void FuseIfOnePoint(LandmarkId a, LandmarkId b);
  void ObserveIfOnePoint(LandmarkId id, const Observation& observation);
  std::optional<Eigen::Vector3d> CommonPoint(const Landmark& kept, const Landmark& absorbed) const;
  // The point that explains all views; none where it does not to the gate.
  std::optional<Eigen::Vector3d> RefineWithinGate(const std::vector<PointView>& views,
                                                  const Eigen::Vector3d& initial) const;
  PointView ViewOf(const Observation& observation) const;
  void AddViews(const Landmark& landmark, std::vector<PointView>& views) const;

  const std::unordered_set<KeyframeId> trusted_;
  const LandmarkSearchOptions options_;
  WeldingDraft& draft_;
  const Atlas& atlas_;  // the draft's, as it becomes
};

// Makes of both sides' landmarks one set (Elvira et al. 2019, section "Seamless map merging", step 3): first the pairs
// of the match, then the landmarks of each side are looked for in the keyframes of the other, on both sides of the
// `searched` keyframes nearest the seam. What lies beyond the moved side of a loop is where it drifted to: its views do
// not count.
void FuseAcrossSeam(const WeldingWindow& window, const std::vector<std::pair<LandmarkId, LandmarkId>>& pairs,
                    std::size_t searched, const LandmarkSearchOptions& options, WeldingDraft& draft);

// The landmarks that keyframes of both sides see, ascending.
std::vector<LandmarkId> CommonLandmarks(const Atlas& atlas, const WeldingWindow& window);

}  // namespace pangaea
