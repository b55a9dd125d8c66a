#include "common/map/edits/move_landmarks.h"

#include <algorithm>

#include "common/map/atlas_editor.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {

Status Validate(const MoveLandmarks& edit, const Atlas& atlas) {
  for (const MovedLandmark& moved : edit.landmarks) {
    if (auto status = CheckKnown(atlas, moved.id); !status) return status;
    if (auto status = CheckPointInCamera(moved.point_in_reference); !status) return status;
  }
  return {};
}

void ApplyValid(const MoveLandmarks& edit, AtlasEditor& editor) {
  for (const MovedLandmark& moved : edit.landmarks) {
    const Landmark* landmark = editor.atlas().FindLandmark(moved.id);
    if (landmark == nullptr) continue;
    const Rigid3d& camera_from_map = editor.atlas().FindKeyframe(landmark->reference)->camera_from_map;
    editor.WriteLandmark(moved.id).point_in_map = camera_from_map.Inverse() * moved.point_in_reference;
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
    writer.WritePoint(moved.point_in_reference);
  }
}

void Decode(MapReader& reader, std::uint8_t, MoveLandmarks& edit) {
  constexpr std::size_t kMinBytes = 1 + 3 * sizeof(double);
  edit.landmarks.resize(reader.bytes().Count(kMinBytes));
  for (MovedLandmark& moved : edit.landmarks) {
    moved.id = reader.ReadId<LandmarkTag>();
    moved.point_in_reference = reader.ReadPoint();
  }
}

}  // namespace pangaea
