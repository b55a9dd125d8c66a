#include "common/map/edits/move_keyframes.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "common/map/atlas_editor.h"
#include "common/map/limits.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {
namespace {

Status CheckScale(const MoveKeyframes& edit, const MovedKeyframe& moved, const Atlas& atlas) {
  if (auto status = CheckScale(moved.reference_scale); !status) return status;
  const Keyframe* keyframe = atlas.FindKeyframe(moved.id);
  const bool in_range = moved.scale >= 1.0 / kMaxScale && moved.scale <= kMaxScale &&
                        (keyframe == nullptr || IsTotalScale(keyframe->scale * moved.scale));
  if (in_range && (moved.scale == 1.0 || edit.correction != 0)) return {};
  return Fail(ErrorCode::kInvalidArgument, "keyframe " + ToString(moved.id) + ": it cannot be scaled so");
}

// Where the edit puts the keyframe; nothing where its reference does not say.
std::optional<Rigid3d> NewPose(const MovedKeyframe& moved, const Keyframe& keyframe, const Atlas& atlas) {
  const KeyframeId reference_id = moved.reference.valid() ? moved.reference : keyframe.parent;
  if (!reference_id.valid()) return moved.camera_from_reference;
  const auto reference = atlas.ResolvePose(reference_id);
  if (!reference || reference->keyframe->map != keyframe.map || reference->keyframe->id == keyframe.id) return {};
  const Rigid3d camera_from_asked =
      ScaleLengths(moved.camera_from_reference, LengthFactor(*reference->keyframe, moved.reference_scale));
  if (reference->keyframe->id == reference_id) return camera_from_asked * reference->keyframe->camera_from_map;
  return camera_from_asked * reference->keyframe_from_asked.Inverse() * reference->keyframe->camera_from_map;
}

void ScaleFrames(Keyframe& keyframe, double scale) {
  if (!keyframe.frames) return;
  auto frames = std::make_shared<std::vector<FramePose>>(*keyframe.frames);
  for (FramePose& frame : *frames) frame.reference_from_frame = ScaleLengths(frame.reference_from_frame, scale);
  keyframe.frames = std::move(frames);
}

// Where culled keyframes hung below those that are scaled.
void ScaleCulled(const std::map<KeyframeId, double>& scales, AtlasEditor& editor) {
  if (scales.empty()) return;
  std::vector<std::pair<KeyframeId, CulledKeyframe>> culled;
  editor.atlas().ForEachFormerKeyframe([&](KeyframeId id, const CulledKeyframe* former) {
    if (former != nullptr && scales.contains(editor.atlas().Resolve(id))) culled.emplace_back(id, *former);
  });
  for (auto& [id, former] : culled) {
    former.parent_from_culled = ScaleLengths(former.parent_from_culled, scales.at(editor.atlas().Resolve(id)));
    editor.WriteFormerKeyframe(id, &former);
  }
}

}  // namespace

Status Validate(const MoveKeyframes& edit, const Atlas& atlas) {
  for (const MovedKeyframe& moved : edit.keyframes) {
    if (auto status = CheckKnown(atlas, moved.id); !status) return status;
    if (auto status = CheckPose(moved.camera_from_reference); !status) return status;
    if (auto status = CheckScale(edit, moved, atlas); !status) return status;
    if (!moved.reference.valid()) continue;
    if (auto status = CheckKnown(atlas, moved.reference); !status) return status;
  }
  return {};
}

void ApplyValid(const MoveKeyframes& edit, AtlasEditor& editor) {
  std::map<KeyframeId, double> scales;
  for (const MovedKeyframe& moved : edit.keyframes) {
    const Keyframe* keyframe = editor.atlas().FindKeyframe(moved.id);
    if (keyframe == nullptr || (edit.correction == 0 && keyframe->corrected_at != 0)) continue;
    const auto camera_from_map = NewPose(moved, *keyframe, editor.atlas());
    if (!camera_from_map) continue;
    Keyframe& written = editor.WriteKeyframe(moved.id);
    written.camera_from_map = *camera_from_map;
    if (edit.correction != 0 && moved.settles) written.corrected_at = edit.correction;
    if (moved.scale == 1.0) continue;
    written.scale *= moved.scale;
    ScaleFrames(written, moved.scale);
    scales[moved.id] = moved.scale;
  }
  ScaleCulled(scales, editor);
}

bool TouchesOnly(const MoveKeyframes& edit, SessionId session) {
  return edit.correction == 0 && std::all_of(edit.keyframes.begin(), edit.keyframes.end(),
                                             [&](const MovedKeyframe& moved) { return moved.id.session == session; });
}

void Encode(const MoveKeyframes& edit, MapWriter& writer) {
  writer.bytes().Varint(edit.correction);
  writer.bytes().Varint(edit.keyframes.size());
  for (const MovedKeyframe& moved : edit.keyframes) {
    writer.WriteId(moved.id);
    writer.WriteRigid(moved.camera_from_reference);
    writer.WriteId(moved.reference);
    WriteScale(moved.reference_scale, writer);
    if (edit.correction == 0) continue;
    WriteScale({moved.scale}, writer);
    writer.bytes().Word(static_cast<std::uint8_t>(moved.settles ? 1 : 0));
  }
}

void Decode(MapReader& reader, std::uint8_t version, MoveKeyframes& edit) {
  if (version >= 2) edit.correction = reader.bytes().Varint();
  constexpr std::size_t kMinBytes = 1 + 7 * sizeof(double);
  edit.keyframes.resize(reader.bytes().Count(kMinBytes));
  for (MovedKeyframe& moved : edit.keyframes) {
    moved.id = reader.ReadId<KeyframeTag>();
    moved.camera_from_reference = reader.ReadRigid();
    if (version < 2) continue;
    moved.reference = reader.ReadId<KeyframeTag>();
    moved.reference_scale = ReadScale(reader);
    if (edit.correction == 0) continue;
    moved.scale = ReadScale(reader).value;
    const auto settles = reader.bytes().Word<std::uint8_t>();
    if (settles > 1) reader.bytes().Invalidate();
    moved.settles = settles == 1;
  }
}

}  // namespace pangaea
