#include "server/atlas/welding_edits.h"

#include <utility>
#include <variant>

namespace pangaea {
namespace {

// Those that fit; of a plan nothing without its merge, on which all the rest of it rests. False where none does.
bool TryAll(const std::vector<MapEdit>& edits, ServerDraft& draft) {
  bool any = false;
  for (const MapEdit& edit : edits) {
    const bool fits = draft.Try(edit).has_value();
    if (!fits && std::holds_alternative<MergeMaps>(edit)) break;
    any = any || fits;
  }
  return any;
}

Status Carry(const Correction& correction, ServerDraft& draft) {
  if (Rebase(correction, draft.atlas(), [&draft](MapEdit edit) { return draft.Try(std::move(edit)); })) return {};
  return Fail(ErrorCode::kRefused, "the correction does not fit the atlas");
}

}  // namespace

Status WeldingEdits(const WeldingPlan& plan, const std::optional<Correction>& spread, ServerDraft& draft) {
  if (!TryAll(plan.edits, draft)) {
    return Fail(ErrorCode::kRefused, "what the plan joins is gone or was joined in another way");
  }
  if (auto status = Carry(plan.correction, draft); !status) return status;
  return spread ? Carry(*spread, draft) : Status();
}

Status OptimizationEdits(const OptimizedMap& optimized, ServerDraft& draft) {
  (void)TryAll(optimized.joins, draft);
  for (const Correction& correction : optimized.corrections) {
    if (auto status = Carry(correction, draft); !status) return status;
  }
  (void)TryAll(optimized.removals, draft);
  return {};
}

}  // namespace pangaea
