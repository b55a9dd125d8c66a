#include "common/map/edits/set_vergence.h"

#include <vector>

#include "common/map/atlas_editor.h"
#include "common/map/keyframe_vergence.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {

Status Validate(const SetVergence& edit, const Atlas&) {
  if (edit.session == 0) return Fail(ErrorCode::kInvalidArgument, "a vergence without a session");
  return CheckVergence(edit.vergence);
}

void ApplyValid(const SetVergence& edit, AtlasEditor& editor) {
  std::vector<KeyframeId> other;
  editor.atlas().ForEachKeyframe(edit.session, [&](const Keyframe& keyframe) {
    if (keyframe.data->camera.is_stereo() && keyframe.data->vergence != edit.vergence) other.push_back(keyframe.id);
  });
  for (const KeyframeId id : other) {
    Keyframe& keyframe = editor.WriteKeyframe(id);
    keyframe.data = WithVergence(keyframe.data, edit.vergence);
  }
}

bool TouchesOnly(const SetVergence& edit, SessionId session) { return edit.session == session; }

void Encode(const SetVergence& edit, MapWriter& writer) {
  writer.bytes().Word(edit.session);
  writer.bytes().Word(edit.vergence);
}

void Decode(MapReader& reader, std::uint8_t, SetVergence& edit) {
  edit.session = reader.bytes().Word<SessionId>();
  edit.vergence = reader.bytes().Word<double>();
}

}  // namespace pangaea
