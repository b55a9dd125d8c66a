#include "server/ingest/agent_edit.h"

#include <variant>

#include "common/map/map_edit.h"

namespace pangaea {
namespace {

struct Reconcile {
  const Error& error;
  const Atlas& atlas;

  // It was fused into another here.
  Status operator()(const AddLandmark& edit) const {
    if (atlas.Resolve(edit.id).valid()) return {};
    return tl::make_unexpected(error);
  }
  // Both are alive, but in maps that are two by now.
  Status operator()(const AddObservation&) const { return {}; }
  Status operator()(const FuseLandmarks&) const { return {}; }
  template <typename Other>
  Status operator()(const Other&) const {
    return tl::make_unexpected(error);
  }
};

}  // namespace

Status ApplyAgentEdit(const MapEdit& edit, Atlas& atlas) {
  const Status applied = Apply(edit, atlas);
  if (applied || applied.error().code != ErrorCode::kRefused) return applied;
  return std::visit(Reconcile{applied.error(), atlas}, edit);
}

}  // namespace pangaea
