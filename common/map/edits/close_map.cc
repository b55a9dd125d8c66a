#include "common/map/edits/close_map.h"

#include "common/map/atlas_editor.h"
#include "common/map/map_bytes.h"

namespace pangaea {

Status Validate(const CloseMap& edit, const Atlas& atlas) {
  if (atlas.FindMap(edit.map) != nullptr || atlas.merged_maps().contains(edit.map)) return {};
  return Fail(ErrorCode::kNotFound, "unknown map " + ToString(edit.map));
}

void ApplyValid(const CloseMap& edit, AtlasEditor& editor) {
  if (editor.atlas().FindMap(edit.map) != nullptr) editor.WriteMap(edit.map).closed = true;
}

bool TouchesOnly(const CloseMap& edit, SessionId session) { return edit.map.session == session; }

void Encode(const CloseMap& edit, MapWriter& writer) { writer.WriteId(edit.map); }

void Decode(MapReader& reader, std::uint8_t, CloseMap& edit) { edit.map = reader.ReadId<MapTag>(); }

}  // namespace pangaea
