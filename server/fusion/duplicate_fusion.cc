#include "server/fusion/duplicate_fusion.h"

#include <algorithm>
#include <iterator>

#include "common/map/covisibility.h"
#include "common/mapping/landmark_search.h"

namespace pangaea {
namespace {

void SearchIn(const std::vector<KeyframeId>& keyframes, const std::vector<KeyframeId>& other_side,
              const LandmarkSearchOptions& options, WeldingDraft& draft) {
  for (const KeyframeId id : keyframes) {
    // Anew for each keyframe: the one before may have fused some of them.
    const std::vector<LandmarkId> wanted = LandmarksSeenBy(draft.welded(), other_side);
    draft.Change(SearchLandmarks(draft.welded(), *draft.welded().FindKeyframe(id), wanted, options));
  }
}

}  // namespace

void FusePairs(const std::vector<std::pair<LandmarkId, LandmarkId>>& pairs, double gate, WeldingDraft& draft) {
  for (const auto& [a, b] : pairs) {
    const Landmark* first = draft.welded().FindLandmark(draft.welded().Resolve(a));
    const Landmark* second = draft.welded().FindLandmark(draft.welded().Resolve(b));
    if (first == nullptr || second == nullptr || first == second) continue;
    if (const auto fusion = FuseIfTheyAgree(draft.welded(), *first, *second, gate)) draft.Change(*fusion);
  }
}

void FuseAcrossSeam(const WeldingWindow& window, const LandmarkSearchOptions& options, WeldingDraft& draft) {
  SearchIn(window.kept, window.moved, options, draft);
  SearchIn(window.moved, window.kept, options, draft);
}

std::vector<LandmarkId> CommonLandmarks(const Atlas& atlas, const WeldingWindow& window) {
  const std::vector<LandmarkId> kept = LandmarksSeenBy(atlas, window.kept);
  const std::vector<LandmarkId> moved = LandmarksSeenBy(atlas, window.moved);
  std::vector<LandmarkId> common;
  std::set_intersection(kept.begin(), kept.end(), moved.begin(), moved.end(), std::back_inserter(common));
  return common;
}

}  // namespace pangaea
