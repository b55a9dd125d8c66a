#include "server/place_recognition/place_report.h"

#include "common/base/check.h"

namespace pangaea {

std::string_view ToString(PlaceOutcome outcome) {
  switch (outcome) {
    case PlaceOutcome::kUnknownKeyframe:
      return "unknown_keyframe";
    case PlaceOutcome::kFewLandmarks:
      return "few_landmarks";
    case PlaceOutcome::kNoCandidate:
      return "no_candidate";
    case PlaceOutcome::kFewMatches:
      return "few_matches";
    case PlaceOutcome::kNoMotion:
      return "no_motion";
    case PlaceOutcome::kFewInliers:
      return "few_inliers";
    case PlaceOutcome::kContradicted:
      return "contradicted";
    case PlaceOutcome::kFewAgreeing:
      return "few_agreeing";
    case PlaceOutcome::kRecognized:
      return "recognized";
  }
  PANGAEA_CHECK(false);
}

}  // namespace pangaea
