#include "common/map/edits/add_observation.h"

#include <algorithm>

#include "common/map/atlas_editor.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {
namespace {

const Observation* FindObservation(const Landmark& landmark, KeyframeId keyframe) {
  const auto found = std::find_if(landmark.observations.begin(), landmark.observations.end(),
                                  [&](const Observation& o) { return o.keyframe == keyframe; });
  return found == landmark.observations.end() ? nullptr : &*found;
}

}  // namespace

Status Validate(const AddObservation& edit, const Atlas& atlas) {
  if (auto status = CheckKnown(atlas, edit.landmark); !status) return status;
  if (auto status = CheckKnown(atlas, edit.keyframe); !status) return status;
  const Landmark* landmark = atlas.FindLandmark(atlas.Resolve(edit.landmark));
  const Keyframe* keyframe = atlas.FindKeyframe(edit.keyframe);
  if (landmark == nullptr || keyframe == nullptr) return {};
  if (const Observation* observation = FindObservation(*landmark, edit.keyframe)) {
    if (landmark->id != edit.landmark || observation->keypoint == edit.keypoint) return {};
    return Fail(ErrorCode::kRefused, "keyframe " + ToString(edit.keyframe) + " observes landmark " +
                                         ToString(edit.landmark) + " at another keypoint");
  }
  if (atlas.MapOf(*landmark) != keyframe->map) {
    return Fail(ErrorCode::kRefused,
                "landmark " + ToString(edit.landmark) + " is in another map than keyframe " + ToString(edit.keyframe));
  }
  return CheckFreeKeypoint(*keyframe, edit.keypoint);
}

void ApplyValid(const AddObservation& edit, AtlasEditor& editor) {
  const Landmark* landmark = editor.atlas().FindLandmark(editor.atlas().Resolve(edit.landmark));
  if (landmark == nullptr || editor.atlas().FindKeyframe(edit.keyframe) == nullptr) return;
  if (FindObservation(*landmark, edit.keyframe) != nullptr) return;
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
