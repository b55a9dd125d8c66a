#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/base/stage_recorder.h"
#include "common/map/atlas.h"
#include "common/place/inverted_index.h"
#include "server/place_recognition/place_recognition_options.h"
#include "server/place_recognition/place_report.h"
#include "server/place_recognition/place_view.h"

namespace pangaea {

// A motion to a place that was verified for one keyframe and that too few others could confirm yet.
struct PlaceHypothesis {
  KeyframeId query;
  KeyframeId candidate;
  Similarity3d candidate_from_query;
  std::vector<KeyframeId> agreeing;  // the query included
  std::size_t age = 0;               // keyframes of the query's map that were asked since
};

struct PlaceVerdict {
  PlaceTrial trial;
  std::optional<PlaceMatch> match;   // where the geometry was verified; recognised only if the outcome says so
  std::vector<KeyframeId> agreeing;  // keyframes that confirm the match, the query included
};

// Compares one keyframe with others that may show the same place. Lives as long as one query: refers to the atlas, the
// keyframe, the options and the recorder.
class PlaceVerification {
 public:
  PlaceVerification(const Atlas& atlas, const Keyframe& query, const PlaceRecognitionOptions& options,
                    StageRecorder& stages);

  // Whether the query sees enough landmarks to be compared at all.
  bool possible() const { return own_.keypoints.size() >= options_.geometry.min_matches; }
  // Without an idea of the motion. The candidate is alive.
  PlaceVerdict Compare(const PlaceCandidate& candidate);
  // With the motion that an earlier keyframe found. Both of its keyframes are alive, that one in the query's map.
  PlaceVerdict Confirm(const PlaceHypothesis& hypothesis);

 private:
  std::vector<Match> MatchOwn(std::span<const Keypoint> keypoints, std::span<const Descriptor> descriptors) const;
  std::vector<Match> MatchOwnLandmarks(const Keyframe& candidate, PlaceTrial& trial) const;
  std::optional<Similarity3d> Align(const PlaceView& candidate, std::span<const Match> matches, PlaceTrial& trial);
  std::optional<Similarity3d> FindMotionOf(const PlaceView& candidate, std::span<const Match> matches,
                                           PlaceTrial& trial);
  void Refine(const PlaceView& candidate, const Similarity3d& candidate_from_query, PlaceVerdict& verdict);
  void Ask(KeyframeId candidate, const Similarity3d& candidate_from_query, PlaceVerdict& verdict);
  PlaceMatch MakeMatch(const PlaceView& candidate, const PlaceAlignment& alignment, const PlaceTrial& trial);
  const PlaceView& View();

  const Atlas& atlas_;
  const Keyframe& query_;
  const PlaceRecognitionOptions& options_;
  StageRecorder& stages_;
  LandmarkAppearances own_;        // of the query alone
  std::optional<PlaceView> view_;  // with its covisible keyframes; made when it is needed, since mostly it is not
};

}  // namespace pangaea
