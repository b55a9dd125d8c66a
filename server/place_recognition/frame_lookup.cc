#include "server/place_recognition/frame_lookup.h"

#include <algorithm>
#include <span>
#include <vector>

#include "common/base/range_check.h"
#include "common/map/covisibility.h"
#include "common/map/metric_map.h"
#include "server/place_recognition/place_agreement.h"

namespace pangaea {
namespace {

class Lookup {
 public:
  Lookup(const Atlas& atlas, const KeyframeData& frame, const FrameLookupOptions& options,
         const PlaceRecognitionOptions& place)
      : atlas_(atlas), frame_(frame), options_(options), place_(place) {}

  std::vector<KeyframeId> Candidates(const InvertedIndex& index, const VocabularyTree& vocabulary) const {
    const auto admits = [this](const KeyframeId& id) {
      const Keyframe* keyframe = atlas_.FindKeyframe(id);
      return keyframe != nullptr && (!frame_.camera.is_stereo() || IsMetric(atlas_, keyframe->map));
    };
    std::vector<KeyframeId> candidates;
    const BagOfWords bag = vocabulary.Bag(frame_.features.descriptors);
    for (const PlaceCandidate& candidate : index.Query(bag, options_.query, admits).ranked) {
      candidates.push_back(candidate.keyframe);
    }
    return candidates;
  }

  FrameLookup Compare(const std::vector<KeyframeId>& candidates) const {
    FrameLookup best{.outcome = FrameOutcome::kNoPose};
    CompareAll(candidates, 1, best);
    if (!best.is_found()) CompareAll(candidates, options_.candidate_window, best);
    best.candidates = candidates.size();
    return best;
  }

 private:
  // The first few mostly hold the place: the others are compared only where these do not.
  void CompareAll(std::span<const KeyframeId> candidates, std::size_t window, FrameLookup& best) const {
    for (std::size_t first = 0; first < candidates.size() && !best.is_found(); first += options_.at_once) {
      CompareSome(candidates.subspan(first, std::min(options_.at_once, candidates.size() - first)), window, best);
    }
  }

  void CompareSome(std::span<const KeyframeId> candidates, std::size_t window, FrameLookup& best) const {
    const auto poses =
        Relocalize(frame_.camera, frame_.features, atlas_, candidates, window, options_.relocalization, options_.seed);
    for (const Relocalized& pose : poses) {
      const FrameLookup lookup = Verify(pose);
      if (lookup.outcome > best.outcome) best = lookup;
      if (best.is_found()) return;
    }
  }

  FrameLookup Verify(const Relocalized& rough) const {
    const Keyframe& keyframe = *atlas_.FindKeyframe(rough.keyframe);
    FrameLookup lookup{.outcome = FrameOutcome::kFewInliers, .keyframe = keyframe.id, .map = keyframe.map};
    const std::vector<SoughtLandmark> sought = Around(keyframe.id);
    const auto location =
        LocateByDescriptors(frame_.camera, frame_.features, atlas_, rough.camera_from_map, sought, options_.guided);
    if (!location) return lookup;
    lookup.inliers = location->pose.inliers;
    lookup.found = location->found;
    const Rigid3d& camera_from_map = location->pose.camera_from_map;
    lookup.camera_from_keyframe = camera_from_map * keyframe.camera_from_map.Inverse();
    if (lookup.inliers < options_.min_inliers || lookup.inliers < options_.min_agreement * lookup.found) return lookup;
    lookup.outcome = FrameOutcome::kUnobservable;
    const double depth = MedianDepth(*location, atlas_, sought);
    if (!PositionIsObservable(location->pose, depth, IsMetric(atlas_, keyframe.map), options_.observability)) {
      return lookup;
    }
    const PlaceWitness witness = AskFrame(atlas_, frame_, keyframe, camera_from_map, place_);
    lookup.expected_cells = witness.expected_cells;
    lookup.confirmed_cells = witness.confirmed_cells;
    lookup.outcome = witness.vote == PlaceVote::kYes ? FrameOutcome::kFound : FrameOutcome::kContradicted;
    return lookup;
  }

  std::vector<SoughtLandmark> Around(KeyframeId keyframe) const {
    ObserverCenters centers(atlas_);
    std::vector<SoughtLandmark> sought;
    for (const LandmarkId id : LandmarksSeenBy(atlas_, GrowWindow(atlas_, keyframe, options_.window))) {
      sought.push_back({id, centers.SpreadOf(*atlas_.FindLandmark(id))});
    }
    return sought;
  }

  const Atlas& atlas_;
  const KeyframeData& frame_;
  const FrameLookupOptions& options_;
  const PlaceRecognitionOptions& place_;
};

}  // namespace

Status FrameLookupOptions::Check() const {
  if (const Status status = query.Check(); !status) return status;
  if (const Status status = relocalization.pose.Check(); !status) return status;
  if (const Status status = observability.Check(); !status) return status;
  return RangeCheck("frame lookup")
      .In("at_once", at_once, 1, 100)
      .In("candidate_window", candidate_window, 1, 1000)
      .In("window", window, 1, 10000)
      .In("min_inliers", min_inliers, 6, 1000)
      .In("min_agreement", min_agreement, 0.0, 1.0)
      .status();
}

std::string_view ToString(FrameOutcome outcome) {
  switch (outcome) {
    case FrameOutcome::kFewFeatures:
      return "few features";
    case FrameOutcome::kNoCandidate:
      return "no candidate";
    case FrameOutcome::kNoPose:
      return "no pose";
    case FrameOutcome::kFewInliers:
      return "few inliers";
    case FrameOutcome::kUnobservable:
      return "position not observable";
    case FrameOutcome::kContradicted:
      return "contradicted by parts of the image";
    case FrameOutcome::kFound:
      return "found";
  }
  return "unknown";
}

FrameLookup LookUpFrame(const Atlas& atlas, const InvertedIndex& index, const VocabularyTree& vocabulary,
                        const KeyframeData& frame, const FrameLookupOptions& options,
                        const PlaceRecognitionOptions& place) {
  if (frame.features.keypoints.size() < options.relocalization.min_matches) return {};
  const Lookup lookup(atlas, frame, options, place);
  const std::vector<KeyframeId> candidates = lookup.Candidates(index, vocabulary);
  if (candidates.empty()) return {.outcome = FrameOutcome::kNoCandidate};
  return lookup.Compare(candidates);
}

}  // namespace pangaea
