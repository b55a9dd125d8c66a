#include <iomanip>
#include <sstream>

#include "server/fusion/welding.h"

namespace pangaea {
namespace {

const char* Words(WeldingRefusalReason reason) {
  switch (reason) {
    case WeldingRefusalReason::kGone:
      return "a keyframe of the match is gone";
    case WeldingRefusalReason::kCancelled:
      return "cancelled";
    case WeldingRefusalReason::kContradiction:
      return "the loop contradicts the map between its ends";
    case WeldingRefusalReason::kTooFewCommonLandmarks:
      return "too few landmarks are seen from both sides";
    case WeldingRefusalReason::kSidesDisagree:
      return "what both sides see does not fit";
    case WeldingRefusalReason::kResidualGrew:
      return "the sides do not fit without bending";
  }
  return "";
}

std::string Figures(const WeldingEvidence& evidence) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2);
  if (const auto& compared = evidence.match.compared) {
    text << "maps compared: " << evidence.match.inliers << " landmarks in " << compared->cells << " places at "
         << compared->rms << " m, " << 100.0 * compared->surface_share << " % of the surfaces agree, ";
  } else {
    text << evidence.match.inliers << " matches at " << evidence.match.rms_pixels << " sigma, ";
  }
  text << evidence.common_landmarks << " common landmarks, " << evidence.fused << " fused, " << evidence.added
       << " observations added, " << evidence.removed << " removed, inliers " << 100.0 * evidence.common.inlier_share()
       << " %, cost " << evidence.before.mean_cost() << " to " << evidence.after.mean_cost() << ", rms "
       << evidence.before.rms_inliers() << " to " << evidence.after.rms_inliers() << " sigma";
  if (evidence.scale != 1.0) text << ", scale " << std::setprecision(4) << evidence.scale << std::setprecision(2);
  if (evidence.drift.max_rotation > 0.0) {
    text << ", drift " << evidence.drift.translation << " of " << evidence.drift.max_translation << " allowed, "
         << evidence.drift.rotation << " of " << evidence.drift.max_rotation << " degrees";
  }
  return text.str();
}

}  // namespace

std::string Describe(const WeldingPlan& plan) {
  const std::string ends = ToString(plan.moved) + " onto " + ToString(plan.kept);
  const std::string what =
      plan.is_merge() ? "map " + ToString(plan.absorbed) + " merged into " + ToString(plan.map) : "loop closed";
  return what + " at " + ends + ": " + Figures(plan.evidence);
}

std::string Describe(const WeldingRefusal& refusal) {
  return std::string(Words(refusal.reason)) + ": " + Figures(refusal.evidence);
}

}  // namespace pangaea
