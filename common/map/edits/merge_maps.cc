#include "common/map/edits/merge_maps.h"

#include <utility>
#include <vector>

#include "common/map/atlas_editor.h"
#include "common/map/edits/reference_scale.h"
#include "common/map/limits.h"
#include "common/map/map_bytes.h"
#include "common/map/spanning_tree.h"
#include "common/map/validation.h"

namespace pangaea {
namespace {

Status CheckAttachment(const Atlas& atlas, KeyframeId attachment, MapId map) {
  const Keyframe* keyframe = atlas.FindKeyframe(atlas.Resolve(attachment));
  if (keyframe != nullptr && keyframe->map == map) return {};
  return Fail(ErrorCode::kNotFound, "attachment " + ToString(attachment) + " is not in map " + ToString(map));
}

Status CheckCoordinates(const Atlas& atlas, const MergeMaps& edit) {
  const auto fits = [&](const Keyframe& keyframe) {
    const Eigen::Vector3d center = edit.survivor_from_absorbed * keyframe.camera_from_map.Inverse().translation();
    return center.norm() <= kMaxCoordinate && IsTotalScale(edit.survivor_from_absorbed.scale() * keyframe.scale);
  };
  bool all_fit = true;
  for (const KeyframeId id : ParentsFirst(atlas, edit.absorbed)) {
    all_fit = all_fit && fits(*atlas.FindKeyframe(id));
  }
  if (all_fit) return {};
  return Fail(ErrorCode::kInvalidArgument, "the merge takes map " + ToString(edit.absorbed) + " out of all bounds");
}

// Reverses the edges on the way from `new_root` to the root.
void Reroot(KeyframeId new_root, AtlasEditor& editor) {
  KeyframeId parent;
  for (KeyframeId id = new_root; id.valid();) {
    const KeyframeId next = editor.atlas().FindKeyframe(id)->parent;
    editor.SetParent(id, parent);
    parent = std::exchange(id, next);
  }
}

void TransformKeyframes(std::span<const KeyframeId> ids, const MergeMaps& edit, AtlasEditor& editor) {
  const double scale = edit.survivor_from_absorbed.scale();
  for (const KeyframeId id : ids) {
    Keyframe& keyframe = editor.WriteKeyframe(id);
    keyframe.map = edit.survivor;
    keyframe.camera_from_map = edit.survivor_from_absorbed.TransformCamera(keyframe.camera_from_map);
    keyframe.scale *= scale;
    if (edit.correction != 0) keyframe.corrected_at = edit.correction;
    if (!keyframe.frames || scale == 1.0) continue;
    auto frames = std::make_shared<std::vector<FramePose>>(*keyframe.frames);
    for (FramePose& frame : *frames) frame.reference_from_frame = ScaleLengths(frame.reference_from_frame, scale);
    keyframe.frames = std::move(frames);
  }
}

// Each landmark is moved once, by its reference.
void TransformLandmarks(std::span<const KeyframeId> ids, const Similarity3d& survivor_from_absorbed,
                        AtlasEditor& editor) {
  for (const KeyframeId id : ids) {
    const std::vector<LandmarkId> landmarks = editor.atlas().FindKeyframe(id)->landmarks;
    for (const LandmarkId landmark : landmarks) {
      if (!landmark.valid() || editor.atlas().FindLandmark(landmark)->reference != id) continue;
      Landmark& moved = editor.WriteLandmark(landmark);
      moved.point_in_map = survivor_from_absorbed * moved.point_in_map;
    }
  }
}

// Lengths that are held outside keyframes: of culled keyframes and of loop edges. Before the keyframes change maps.
void ScaleRelations(const MergeMaps& edit, AtlasEditor& editor) {
  const double scale = edit.survivor_from_absorbed.scale();
  if (scale == 1.0) return;
  const Atlas& atlas = editor.atlas();
  std::vector<std::pair<KeyframeId, CulledKeyframe>> culled;
  atlas.ForEachFormerKeyframe([&](KeyframeId id, const CulledKeyframe* former) {
    const Keyframe* alive = atlas.FindKeyframe(atlas.Resolve(id));
    if (former != nullptr && alive != nullptr && alive->map == edit.absorbed) culled.emplace_back(id, *former);
  });
  for (auto& [id, former] : culled) {
    former.parent_from_culled = ScaleLengths(former.parent_from_culled, scale);
    editor.WriteFormerKeyframe(id, &former);
  }
  for (LoopEdge& edge : editor.WriteLoopEdges()) {
    if (atlas.FindKeyframe(edge.from)->map != edit.absorbed) continue;
    const Similarity3d& s = edge.to_from_from;
    edge.to_from_from =
        Similarity3d::FromNormalized(s.scale(), s.rotation(), scale * s.translation()).value_or(edge.to_from_from);
  }
}

void JoinMapInfo(const MergeMaps& edit, AtlasEditor& editor) {
  const MapInfo absorbed = *editor.atlas().FindMap(edit.absorbed);
  MapInfo& survivor = editor.WriteMap(edit.survivor);
  survivor.keyframes += absorbed.keyframes;
  survivor.landmarks += absorbed.landmarks;
  survivor.closed = survivor.closed && absorbed.closed;
  editor.ForwardMap(edit.absorbed, edit.survivor);
}

}  // namespace

Status Validate(const MergeMaps& edit, const Atlas& atlas) {
  if (edit.survivor == edit.absorbed) return Fail(ErrorCode::kInvalidArgument, "a map cannot be merged with itself");
  for (const MapId map : {edit.survivor, edit.absorbed}) {
    if (atlas.FindMap(map) == nullptr) return Fail(ErrorCode::kNotFound, "unknown map " + ToString(map));
  }
  if (auto status = CheckSimilarity(edit.survivor_from_absorbed); !status) return status;
  if (auto status = CheckAttachment(atlas, edit.survivor_attachment, edit.survivor); !status) return status;
  if (auto status = CheckAttachment(atlas, edit.absorbed_attachment, edit.absorbed); !status) return status;
  return CheckCoordinates(atlas, edit);
}

void ApplyValid(const MergeMaps& edit, AtlasEditor& editor) {
  const KeyframeId absorbed_attachment = editor.atlas().Resolve(edit.absorbed_attachment);
  const KeyframeId survivor_attachment = editor.atlas().Resolve(edit.survivor_attachment);
  const std::vector<KeyframeId> absorbed = ParentsFirst(editor.atlas(), edit.absorbed);
  ScaleRelations(edit, editor);
  Reroot(absorbed_attachment, editor);
  editor.SetParent(absorbed_attachment, survivor_attachment);
  TransformLandmarks(absorbed, edit.survivor_from_absorbed, editor);
  TransformKeyframes(absorbed, edit, editor);
  JoinMapInfo(edit, editor);
}

bool TouchesOnly(const MergeMaps& edit, SessionId session) {
  return edit.correction == 0 && edit.survivor.session == session && edit.absorbed.session == session;
}

void Encode(const MergeMaps& edit, MapWriter& writer) {
  writer.WriteId(edit.survivor);
  writer.WriteId(edit.absorbed);
  writer.WriteSimilarity(edit.survivor_from_absorbed);
  writer.WriteId(edit.absorbed_attachment);
  writer.WriteId(edit.survivor_attachment);
  writer.bytes().Varint(edit.correction);
}

void Decode(MapReader& reader, std::uint8_t version, MergeMaps& edit) {
  edit.survivor = reader.ReadId<MapTag>();
  edit.absorbed = reader.ReadId<MapTag>();
  edit.survivor_from_absorbed = reader.ReadSimilarity();
  edit.absorbed_attachment = reader.ReadId<KeyframeTag>();
  edit.survivor_attachment = reader.ReadId<KeyframeTag>();
  if (version >= 2) edit.correction = reader.bytes().Varint();
}

}  // namespace pangaea
