#include "common/map/edits/move_landmarks.h"

#include <algorithm>
#include <optional>

#include "common/map/atlas_editor.h"
#include "common/map/edits/point_form.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {
namespace {

// Where the edit puts the landmark; nothing where its reference does not say.
std::optional<Eigen::Vector3d> NewPoint(const MovedLandmark& moved, const Landmark& landmark, const Atlas& atlas) {
  const KeyframeId reference_id = moved.reference.valid() ? moved.reference : landmark.reference;
  const auto reference = atlas.ResolvePose(reference_id);
  if (!reference || reference->keyframe->map != atlas.MapOf(landmark)) return {};
  const Eigen::Vector3d point_in_asked =
      LengthFactor(*reference->keyframe, moved.reference_scale) * moved.point_in_reference;
  const Rigid3d map_from_keyframe = reference->keyframe->camera_from_map.Inverse();
  if (reference->keyframe->id == reference_id) return map_from_keyframe * point_in_asked;
  return map_from_keyframe * (reference->keyframe_from_asked * point_in_asked);
}

}  // namespace

Status Validate(const MoveLandmarks& edit, const Atlas& atlas) {
  for (const MovedLandmark& moved : edit.landmarks) {
    if (auto status = CheckKnown(atlas, moved.id); !status) return status;
    if (auto status = CheckPoint(moved.point_in_reference); !status) return status;
    if (auto status = CheckScale(moved.reference_scale); !status) return status;
    if (!moved.reference.valid()) continue;
    if (auto status = CheckKnown(atlas, moved.reference); !status) return status;
  }
  return {};
}

void ApplyValid(const MoveLandmarks& edit, AtlasEditor& editor) {
  for (const MovedLandmark& moved : edit.landmarks) {
    const Landmark* landmark = editor.atlas().FindLandmark(moved.id);
    if (landmark == nullptr) continue;
    const auto point_in_map = NewPoint(moved, *landmark, editor.atlas());
    if (point_in_map) editor.WriteLandmark(moved.id).point_in_map = *point_in_map;
  }
}

bool TouchesOnly(const MoveLandmarks& edit, SessionId session) {
  return std::all_of(edit.landmarks.begin(), edit.landmarks.end(),
                     [&](const MovedLandmark& moved) { return moved.id.session == session; });
}

void Encode(const MoveLandmarks& edit, MapWriter& writer) {
  writer.bytes().Varint(edit.landmarks.size());
  for (const MovedLandmark& moved : edit.landmarks) {
    writer.WriteId(moved.id);
    WriteCompactPoint(moved.point_in_reference, writer);
    writer.WriteId(moved.reference);
    WriteScale(moved.reference_scale, writer);
  }
}

void Decode(MapReader& reader, std::uint8_t version, MoveLandmarks& edit) {
  constexpr std::size_t kMinBytes = 1 + 3 * sizeof(float);
  edit.landmarks.resize(reader.bytes().Count(kMinBytes));
  for (MovedLandmark& moved : edit.landmarks) {
    moved.id = reader.ReadId<LandmarkTag>();
    moved.point_in_reference = version >= 2 ? ReadCompactPoint(reader) : reader.ReadPoint();
    if (version < 2) continue;
    moved.reference = reader.ReadId<KeyframeTag>();
    moved.reference_scale = ReadScale(reader);
  }
}

}  // namespace pangaea
