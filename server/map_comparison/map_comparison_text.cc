#include <iomanip>
#include <sstream>

#include "server/map_comparison/map_comparison.h"

namespace pangaea {

const char* ToString(MapComparisonOutcome outcome) {
  switch (outcome) {
    case MapComparisonOutcome::kNotComparable:
      return "not comparable";
    case MapComparisonOutcome::kNoMotion:
      return "no motion";
    case MapComparisonOutcome::kAmbiguous:
      return "several motions";
    case MapComparisonOutcome::kFewPairs:
      return "few pairs";
    case MapComparisonOutcome::kNarrow:
      return "all pairs close together";
    case MapComparisonOutcome::kSmallOverlap:
      return "a small overlap";
    case MapComparisonOutcome::kSurfacesDisagree:
      return "the surfaces disagree";
    case MapComparisonOutcome::kOnePlace:
      return "one place";
  }
  return "";
}

std::string Describe(const MapComparison& comparison) {
  std::ostringstream text;
  text << ToString(comparison.outcome) << ": " << comparison.matches << " landmarks look alike, " << comparison.support
       << " support the motion and " << comparison.rival_support << " another; " << comparison.pairs << " pairs in "
       << comparison.cells << " places; they overlap by " << std::fixed << std::setprecision(0)
       << 100.0 * comparison.overlap << " %, " << 100.0 * comparison.surface_share << " % of the surfaces agree";
  return text.str();
}

}  // namespace pangaea
