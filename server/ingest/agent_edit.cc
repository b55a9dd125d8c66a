#include "server/ingest/agent_edit.h"

#include <variant>

#include "common/map/map_edit.h"

namespace pangaea {
namespace {

struct Reconcile {
  const Error& error;
  Atlas& atlas;

  // It was fused into another here; or the agent has forgotten it and says it anew, as it knows it now.
  Status operator()(const AddLandmark& edit) const {
    const LandmarkId present = atlas.Resolve(edit.id);
    if (!present.valid()) return tl::make_unexpected(error);
    if (present != edit.id) return {};
    (void)Apply(AddObservation{edit.id, edit.reference, edit.keypoint}, atlas);
    (void)Apply(MoveLandmarks{{{edit.id, edit.point_in_reference, edit.reference, edit.reference_scale}}}, atlas);
    return {};
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
