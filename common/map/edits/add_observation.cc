#include "common/map/edits/add_observation.h"

#include <algorithm>

#include "common/map/atlas_editor.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {
namespace {

bool IsObservedFrom(const Landmark& landmark, KeyframeId keyframe) {
  return std::any_of(landmark.observations.begin(), landmark.observations.end(),
                     [&](const Observation& o) { return o.keyframe == keyframe; });
}

}  // namespace

Status Validate(const AddObservation& edit, const Atlas& atlas) {
  if (auto status = CheckKnown(atlas, edit.landmark); !status) return status;
  if (auto status = CheckKnown(atlas, edit.keyframe); !status) return status;
  const Landmark* landmark = atlas.FindLandmark(atlas.Resolve(edit.landmark));
  const Keyframe* keyframe = atlas.FindKeyframe(edit.keyframe);
  if (landmark == nullptr || keyframe == nullptr) return {};
  if (atlas.MapOf(*landmark) != keyframe->map) {
    return Fail(ErrorCode::kRefused,
                "landmark " + ToString(edit.landmark) + " is in another map than keyframe " + ToString(edit.keyframe));
  }
  return CheckKeypoint(*keyframe, edit.keypoint);
}

void ApplyValid(const AddObservation& edit, AtlasEditor& editor) {
  const Landmark* landmark = editor.atlas().FindLandmark(editor.atlas().Resolve(edit.landmark));
  const Keyframe* keyframe = editor.atlas().FindKeyframe(edit.keyframe);
  if (landmark == nullptr || keyframe == nullptr) return;
  if (IsObservedFrom(*landmark, edit.keyframe) || keyframe->landmarks[edit.keypoint].valid()) return;
  editor.Observe(landmark->id, edit.keyframe, edit.keypoint);
}

bool TouchesOnly(const AddObservation& edit, SessionId session) { return edit.keyframe.session == session; }

void Encode(const AddObservation& edit, MapWriter& writer) {
  writer.WriteId(edit.landmark);
  writer.WriteId(edit.keyframe);
  writer.bytes().Varint(edit.keypoint);
}

void Decode(MapReader& reader, std::uint8_t, AddObservation& edit) {
  edit.landmark = reader.ReadId<LandmarkTag>();
  edit.keyframe = reader.ReadId<KeyframeTag>();
  edit.keypoint = reader.ReadCounter();
}

}  // namespace pangaea
