#include "common/map/edits/move_keyframes.h"

#include <algorithm>

#include "common/map/atlas_editor.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {

Status Validate(const MoveKeyframes& edit, const Atlas& atlas) {
  for (const MovedKeyframe& moved : edit.keyframes) {
    if (auto status = CheckKnown(atlas, moved.id); !status) return status;
    if (auto status = CheckPose(moved.camera_from_parent); !status) return status;
  }
  return {};
}

void ApplyValid(const MoveKeyframes& edit, AtlasEditor& editor) {
  for (const MovedKeyframe& moved : edit.keyframes) {
    const Keyframe* keyframe = editor.atlas().FindKeyframe(moved.id);
    if (keyframe == nullptr) continue;
    const Keyframe* parent = editor.atlas().FindKeyframe(keyframe->parent);
    const Rigid3d camera_from_map =
        parent == nullptr ? moved.camera_from_parent : moved.camera_from_parent * parent->camera_from_map;
    editor.WriteKeyframe(moved.id).camera_from_map = camera_from_map;
  }
}

bool TouchesOnly(const MoveKeyframes& edit, SessionId session) {
  return std::all_of(edit.keyframes.begin(), edit.keyframes.end(),
                     [&](const MovedKeyframe& moved) { return moved.id.session == session; });
}

void Encode(const MoveKeyframes& edit, MapWriter& writer) {
  writer.bytes().Varint(edit.keyframes.size());
  for (const MovedKeyframe& moved : edit.keyframes) {
    writer.WriteId(moved.id);
    writer.WriteRigid(moved.camera_from_parent);
  }
}

void Decode(MapReader& reader, std::uint8_t, MoveKeyframes& edit) {
  constexpr std::size_t kMinBytes = 1 + 7 * sizeof(double);
  edit.keyframes.resize(reader.bytes().Count(kMinBytes));
  for (MovedKeyframe& moved : edit.keyframes) {
    moved.id = reader.ReadId<KeyframeTag>();
    moved.camera_from_parent = reader.ReadRigid();
  }
}

}  // namespace pangaea
