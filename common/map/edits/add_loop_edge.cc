#include "common/map/edits/add_loop_edge.h"

#include "common/map/atlas_editor.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {

Status Validate(const AddLoopEdge& edit, const Atlas& atlas) {
  if (auto status = CheckKnown(atlas, edit.from); !status) return status;
  if (auto status = CheckKnown(atlas, edit.to); !status) return status;
  if (auto status = CheckSimilarity(edit.to_from_from); !status) return status;
  if (edit.from == edit.to) {
    return Fail(ErrorCode::kInvalidArgument, "a loop edge from keyframe " + ToString(edit.from) + " to itself");
  }
  const Keyframe* from = atlas.FindKeyframe(atlas.Resolve(edit.from));
  const Keyframe* to = atlas.FindKeyframe(atlas.Resolve(edit.to));
  if (from == nullptr || to == nullptr || from->map == to->map) return {};
  return Fail(ErrorCode::kRefused,
              "keyframes " + ToString(edit.from) + " and " + ToString(edit.to) + " are in different maps");
}

void ApplyValid(const AddLoopEdge& edit, AtlasEditor& editor) {
  const auto from = editor.atlas().ResolvePose(edit.from);
  const auto to = editor.atlas().ResolvePose(edit.to);
  if (!from || !to || from->keyframe == to->keyframe) return;
  LoopEdge edge{from->keyframe->id, to->keyframe->id, edit.to_from_from};
  if (edge.from != edit.from) edge.to_from_from = edge.to_from_from * Similarity3d(from->keyframe_from_asked.Inverse());
  if (edge.to != edit.to) edge.to_from_from = Similarity3d(to->keyframe_from_asked) * edge.to_from_from;
  editor.WriteLoopEdges().push_back(edge);
}

bool TouchesOnly(const AddLoopEdge& edit, SessionId session) {
  return edit.from.session == session && edit.to.session == session;
}

void Encode(const AddLoopEdge& edit, MapWriter& writer) {
  writer.WriteId(edit.from);
  writer.WriteId(edit.to);
  writer.WriteSimilarity(edit.to_from_from);
}

void Decode(MapReader& reader, std::uint8_t, AddLoopEdge& edit) {
  edit.from = reader.ReadId<KeyframeTag>();
  edit.to = reader.ReadId<KeyframeTag>();
  edit.to_from_from = reader.ReadSimilarity();
}

}  // namespace pangaea
