#include "common/map/edits/fuse_landmarks.h"

#include "common/map/atlas_editor.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {
Status Validate(const FuseLandmarks& edit, const Atlas& atlas) {
  if (auto status = CheckKnown(atlas, edit.kept); !status) return status;
  if (auto status = CheckKnown(atlas, edit.absorbed); !status) return status;
  if (edit.kept == edit.absorbed) {
    return Fail(ErrorCode::kInvalidArgument, "landmark " + ToString(edit.kept) + " cannot be fused with itself");
  }
  const Landmark* kept = atlas.FindLandmark(atlas.Resolve(edit.kept));
  const Landmark* absorbed = atlas.FindLandmark(atlas.Resolve(edit.absorbed));
  if (kept == nullptr || absorbed == nullptr || atlas.MapOf(*kept) == atlas.MapOf(*absorbed)) return {};
  return Fail(ErrorCode::kRefused,
              "landmarks " + ToString(edit.kept) + " and " + ToString(edit.absorbed) + " are in different maps");
}

void ApplyValid(const FuseLandmarks& edit, AtlasEditor& editor) {
  const LandmarkId kept = editor.atlas().Resolve(edit.kept);
  if (!kept.valid() || editor.atlas().FindLandmark(edit.absorbed) == nullptr || kept == edit.absorbed) return;
  editor.Fuse(kept, edit.absorbed);
}

bool TouchesOnly(const FuseLandmarks& edit, SessionId session) { return edit.absorbed.session == session; }

void Encode(const FuseLandmarks& edit, MapWriter& writer) {
  writer.WriteId(edit.kept);
  writer.WriteId(edit.absorbed);
}

void Decode(MapReader& reader, std::uint8_t, FuseLandmarks& edit) {
  edit.kept = reader.ReadId<LandmarkTag>();
  edit.absorbed = reader.ReadId<LandmarkTag>();
}

}  // namespace pangaea
