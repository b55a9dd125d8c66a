#include "agent/uplink/confirmed_atlas.h"

#include <utility>

#include "common/map/map_edit.h"

namespace pangaea {
namespace {

// Decoded payload is a copy of what the agent holds already: tens of kilobytes a keyframe.
void SharePayload(MapEdit& edit, const Atlas& mirror) {
  auto* added = std::get_if<AddKeyframe>(&edit);
  if (added == nullptr) return;
  if (const Keyframe* keyframe = mirror.FindKeyframe(added->id)) added->data = keyframe->data;
}

}  // namespace

bool ConfirmedAtlas::Take(const Envelope& envelope, const Atlas& mirror) {
  auto edits = DecodeEdits(envelope.edits);
  if (!edits) return false;
  Atlas changed = atlas_;
  for (MapEdit& edit : *edits) {
    SharePayload(edit, mirror);
    if (!Apply(edit, changed)) return false;
  }
  atlas_ = std::move(changed);
  return true;
}

}  // namespace pangaea
