#include "server/atlas/welding_edits.h"

#include <iterator>
#include <utility>

#include "common/map/map_edit.h"

namespace pangaea {
namespace {

// Rebases a correction onto the draft, brings the draft up to it, and appends the edits. False where they do not fit.
bool Append(const Correction& correction, Atlas& draft, std::vector<MapEdit>& edits) {
  std::vector<MapEdit> moves = Rebase(correction, draft);
  for (const MapEdit& move : moves) {
    if (!Apply(move, draft)) return false;
  }
  std::move(moves.begin(), moves.end(), std::back_inserter(edits));
  return true;
}

}  // namespace

Result<std::vector<MapEdit>> WeldingEdits(const WeldingPlan& plan, const std::optional<Correction>& spread,
                                          const Atlas& current) {
  Atlas draft = current;
  std::vector<MapEdit> edits = ApplyTolerantly(plan.edits, draft);
  if (edits.empty()) return Fail(ErrorCode::kRefused, "what the plan joins is gone or was joined in another way");
  bool fits = Append(plan.correction, draft, edits);
  if (spread) fits = fits && Append(*spread, draft, edits);
  if (!fits) return Fail(ErrorCode::kRefused, "the correction does not fit the atlas");
  return edits;
}

Result<std::vector<MapEdit>> OptimizationEdits(const OptimizedMap& optimized, const Atlas& current) {
  Atlas draft = current;
  std::vector<MapEdit> edits = ApplyTolerantly(optimized.joins, draft);
  for (const Correction& correction : optimized.corrections) {
    if (!Append(correction, draft, edits)) return Fail(ErrorCode::kRefused, "the correction does not fit the atlas");
  }
  std::vector<MapEdit> removed = ApplyTolerantly(optimized.removals, draft);
  std::move(removed.begin(), removed.end(), std::back_inserter(edits));
  return edits;
}

}  // namespace pangaea
