#include "server/ingest/agent_edit.h"

#include <algorithm>
#include <variant>

#include "common/map/map_edit.h"

namespace pangaea {
namespace {

// A keyframe with a landmark at each keypoint has no place for one more, not even for a moment.
Status Forward(const AddLandmark& edit, const Keyframe& reference, Atlas& atlas) {
  const LandmarkId there = reference.landmarks[edit.keypoint];
  const auto free = std::ranges::find(reference.landmarks, LandmarkId());
  if (free == reference.landmarks.end()) return {};
  AddLandmark elsewhere = edit;
  elsewhere.keypoint = static_cast<std::uint32_t>(free - reference.landmarks.begin());
  if (auto status = Apply(elsewhere, atlas); !status) return status;
  return Apply(FuseLandmarks{there, edit.id}, atlas);
}

struct Reconcile {
  const Error& error;
  Atlas& atlas;

  Status operator()(const AddLandmark& edit) const {
    if (atlas.Resolve(edit.id).valid()) return {};
    const Keyframe* reference = atlas.FindKeyframe(edit.reference);
    if (reference == nullptr || edit.keypoint >= reference->landmarks.size()) return tl::make_unexpected(error);
    return Forward(edit, *reference, atlas);
  }
  Status operator()(const AddObservation&) const { return {}; }
  Status operator()(const FuseLandmarks&) const { return {}; }
  Status operator()(const RemoveKeyframe&) const { return {}; }  // the root of a map that others joined
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
