#include "common/map/edits/add_keyframe.h"

#include <algorithm>

#include "common/map/atlas_codec.h"
#include "common/map/atlas_editor.h"
#include "common/map/forgetting.h"
#include "common/map/keyframe_vergence.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {
namespace {

Status ValidateRoot(const AddKeyframe& edit, const Atlas& atlas) {
  if (auto status = CheckNewId(edit.map); !status) return status;
  if (atlas.FindMap(edit.map) == nullptr && !atlas.merged_maps().contains(edit.map)) return {};
  return Fail(ErrorCode::kRefused, "keyframe " + ToString(edit.id) + " has no parent in a map that has a root");
}

// Its own agent closed the map. Where other maps were merged into it, that was said of a part of what it is now.
bool IsClosedFor(const AddKeyframe& edit, MapId map, const Atlas& atlas) {
  if (!atlas.FindMap(map)->closed || edit.map != map || edit.map.session != edit.id.session) return false;
  const auto& merged = atlas.merged_maps();
  return std::none_of(merged.begin(), merged.end(), [&](const auto& entry) { return entry.second == map; });
}

Status ValidateChild(const AddKeyframe& edit, const Atlas& atlas) {
  const KeyframeId parent = atlas.Resolve(edit.parent);
  if (!parent.valid()) {
    return Fail(ErrorCode::kNotFound, "keyframe " + ToString(edit.id) + ": unknown parent " + ToString(edit.parent));
  }
  const MapId map = atlas.FindKeyframe(parent)->map;
  if (map != atlas.Resolve(edit.map)) {
    return Fail(ErrorCode::kRefused, "keyframe " + ToString(edit.id) + ": its parent is in another map");
  }
  if (!IsClosedFor(edit, map, atlas)) return {};
  return Fail(ErrorCode::kRefused, "keyframe " + ToString(edit.id) + ": map " + ToString(map) + " is closed");
}

// What was forgotten comes back: where it hangs is known.
Status ValidateRecall(const AddKeyframe& edit, const Keyframe& present) {
  const bool same = edit.data != nullptr && edit.data->stamp_ns == present.data->stamp_ns;
  if (!same || edit.data->features.keypoints.empty()) {
    return Fail(ErrorCode::kRefused, "keyframe " + ToString(edit.id) + " is here already, and this is not what it saw");
  }
  return CheckKeyframeData(*edit.data);
}

}  // namespace

Status Validate(const AddKeyframe& edit, const Atlas& atlas) {
  if (auto status = CheckNewId(edit.id); !status) return status;
  const Keyframe* present = atlas.FindKeyframe(edit.id);
  if (present != nullptr && IsForgotten(*present)) return ValidateRecall(edit, *present);
  if (atlas.Knows(edit.id)) return Fail(ErrorCode::kRefused, "keyframe " + ToString(edit.id) + " is here already");
  if (edit.data == nullptr) return Fail(ErrorCode::kInvalidArgument, "keyframe " + ToString(edit.id) + " has no data");
  if (auto status = CheckPose(edit.camera_from_parent); !status) return status;
  if (auto status = CheckScale(edit.parent_scale); !status) return status;
  if (auto status = CheckKeyframeData(*edit.data); !status) return status;
  return edit.parent.valid() ? ValidateChild(edit, atlas) : ValidateRoot(edit, atlas);
}

void ApplyValid(const AddKeyframe& edit, AtlasEditor& editor) {
  if (const Keyframe* present = editor.atlas().FindKeyframe(edit.id)) {
    // It may have been sent before its rig's vergence was known.
    return editor.RecallKeyframe(edit.id, WithVergence(edit.data, present->data->vergence));
  }
  Keyframe keyframe;
  keyframe.id = edit.id;
  keyframe.map = edit.map;
  keyframe.data = edit.data;
  keyframe.landmarks.resize(edit.data->features.keypoints.size());
  keyframe.camera_from_map = edit.camera_from_parent;
  if (const auto parent = editor.atlas().ResolvePose(edit.parent)) {
    const bool culled = parent->keyframe->id != edit.parent;
    const Rigid3d camera_from_asked =
        ScaleLengths(edit.camera_from_parent, LengthFactor(*parent->keyframe, edit.parent_scale));
    const Rigid3d camera_from_parent =
        culled ? camera_from_asked * parent->keyframe_from_asked.Inverse() : camera_from_asked;
    keyframe.map = parent->keyframe->map;
    keyframe.parent = parent->keyframe->id;
    keyframe.scale = parent->keyframe->scale;
    keyframe.camera_from_map = camera_from_parent * parent->keyframe->camera_from_map;
  }
  editor.InsertKeyframe(std::move(keyframe));
}

// With a parent, the map is a reference: after a merge it may be another session's.
bool TouchesOnly(const AddKeyframe& edit, SessionId session) {
  return edit.id.session == session && (edit.parent.valid() || edit.map.session == session);
}

void Encode(const AddKeyframe& edit, MapWriter& writer) {
  writer.WriteId(edit.id);
  writer.WriteId(edit.map);
  writer.WriteId(edit.parent);
  writer.WriteRigid(edit.camera_from_parent);
  WriteScale(edit.parent_scale, writer);
  EncodeKeyframeData(edit.data ? *edit.data : KeyframeData{}, writer.bytes());
}

void Decode(MapReader& reader, std::uint8_t version, AddKeyframe& edit) {
  edit.id = reader.ReadId<KeyframeTag>();
  edit.map = reader.ReadId<MapTag>();
  edit.parent = reader.ReadId<KeyframeTag>();
  edit.camera_from_parent = reader.ReadRigid();
  if (version >= 2) edit.parent_scale = ReadScale(reader);
  auto data = DecodeKeyframeData(reader.bytes());
  if (data) edit.data = std::move(*data);
}

}  // namespace pangaea
