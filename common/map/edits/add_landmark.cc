#include "common/map/edits/add_landmark.h"

#include "common/map/atlas_editor.h"
#include "common/map/edits/point_form.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {

Status Validate(const AddLandmark& edit, const Atlas& atlas) {
  if (auto status = CheckNewId(edit.id); !status) return status;
  if (auto status = CheckKnown(atlas, edit.reference); !status) return status;
  if (auto status = CheckPointInCamera(edit.point_in_reference); !status) return status;
  if (auto status = CheckScale(edit.reference_scale); !status) return status;
  if (atlas.Resolve(edit.id).valid()) {
    return Fail(ErrorCode::kRefused, "landmark " + ToString(edit.id) + " is here already");
  }
  const Keyframe* reference = atlas.FindKeyframe(edit.reference);
  return reference == nullptr ? Status{} : CheckKeypoint(*reference, edit.keypoint);
}

void ApplyValid(const AddLandmark& edit, AtlasEditor& editor) {
  const Keyframe* reference = editor.atlas().FindKeyframe(edit.reference);
  if (reference == nullptr) return editor.ForgetLandmark(edit.id);
  const LandmarkId there = reference->landmarks[edit.keypoint];
  if (there.valid()) return editor.ForwardLandmark(edit.id, there);
  const Eigen::Vector3d point_in_reference = LengthFactor(*reference, edit.reference_scale) * edit.point_in_reference;
  const Eigen::Vector3d point_in_map = reference->camera_from_map.Inverse() * point_in_reference;
  editor.InsertLandmark(edit.id, point_in_map, edit.reference, edit.keypoint);
}

bool TouchesOnly(const AddLandmark& edit, SessionId session) {
  return edit.id.session == session && edit.reference.session == session;
}

void Encode(const AddLandmark& edit, MapWriter& writer) {
  writer.WriteId(edit.id);
  writer.WriteId(edit.reference);
  writer.bytes().Varint(edit.keypoint);
  WriteCompactPoint(edit.point_in_reference, writer);
  WriteScale(edit.reference_scale, writer);
}

void Decode(MapReader& reader, std::uint8_t version, AddLandmark& edit) {
  edit.id = reader.ReadId<LandmarkTag>();
  edit.reference = reader.ReadId<KeyframeTag>();
  edit.keypoint = reader.ReadCounter();
  edit.point_in_reference = version >= 2 ? ReadCompactPoint(reader) : reader.ReadPoint();
  if (version >= 2) edit.reference_scale = ReadScale(reader);
}

}  // namespace pangaea
