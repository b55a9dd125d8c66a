#include "common/map/edits/remove_landmark.h"

#include "common/map/atlas_editor.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {

Status Validate(const RemoveLandmark& edit, const Atlas& atlas) { return CheckKnown(atlas, edit.id); }

void ApplyValid(const RemoveLandmark& edit, AtlasEditor& editor) {
  if (editor.atlas().FindLandmark(edit.id) != nullptr) editor.RemoveLandmark(edit.id);
}

bool TouchesOnly(const RemoveLandmark& edit, SessionId session) { return edit.id.session == session; }

void Encode(const RemoveLandmark& edit, MapWriter& writer) { writer.WriteId(edit.id); }

void Decode(MapReader& reader, std::uint8_t, RemoveLandmark& edit) { edit.id = reader.ReadId<LandmarkTag>(); }

}  // namespace pangaea
