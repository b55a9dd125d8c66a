#include "common/map/edits/remove_observation.h"

#include <algorithm>

#include "common/map/atlas_editor.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {

Status Validate(const RemoveObservation& edit, const Atlas& atlas) {
  if (auto status = CheckKnown(atlas, edit.landmark); !status) return status;
  return CheckKnown(atlas, edit.keyframe);
}

void ApplyValid(const RemoveObservation& edit, AtlasEditor& editor) {
  const Landmark* landmark = editor.atlas().FindLandmark(editor.atlas().Resolve(edit.landmark));
  if (landmark == nullptr) return;
  const bool observed = std::any_of(landmark->observations.begin(), landmark->observations.end(),
                                    [&](const Observation& o) { return o.keyframe == edit.keyframe; });
  if (observed) editor.Unobserve(landmark->id, edit.keyframe);
}

bool TouchesOnly(const RemoveObservation& edit, SessionId session) { return edit.keyframe.session == session; }

void Encode(const RemoveObservation& edit, MapWriter& writer) {
  writer.WriteId(edit.landmark);
  writer.WriteId(edit.keyframe);
}

void Decode(MapReader& reader, std::uint8_t, RemoveObservation& edit) {
  edit.landmark = reader.ReadId<LandmarkTag>();
  edit.keyframe = reader.ReadId<KeyframeTag>();
}

}  // namespace pangaea
