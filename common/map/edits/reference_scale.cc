#include "common/map/edits/reference_scale.h"

#include "common/map/keyframe.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {
namespace {

enum Form : std::uint8_t { kNone = 0, kOne = 1, kOther = 2 };

}  // namespace

double LengthFactor(const Keyframe& reference, ReferenceScale measured_at) {
  return measured_at.value == 0.0 ? 1.0 : reference.scale / measured_at.value;
}

Rigid3d ScaleLengths(const Rigid3d& rigid, double factor) {
  if (factor == 1.0) return rigid;
  return Rigid3d::FromNormalized(rigid.rotation(), factor * rigid.translation()).value_or(rigid);
}

Status CheckScale(ReferenceScale scale) {
  if (scale.value == 0.0 || IsTotalScale(scale.value)) return {};
  return Fail(ErrorCode::kInvalidArgument, "a scale of " + std::to_string(scale.value) + " is out of range");
}

void WriteScale(ReferenceScale scale, MapWriter& writer) {
  const Form form = scale.value == 0.0 ? kNone : scale.value == 1.0 ? kOne : kOther;
  writer.bytes().Word(static_cast<std::uint8_t>(form));
  if (form == kOther) writer.bytes().Word(scale.value);
}

ReferenceScale ReadScale(MapReader& reader) {
  const auto form = reader.bytes().Word<std::uint8_t>();
  if (form == kNone) return {};
  if (form == kOne) return {1.0};
  const auto value = reader.bytes().Word<double>();
  // Other forms of the other two are no scale: each value has one form.
  if (form != kOther || value == 0.0 || value == 1.0) reader.bytes().Invalidate();
  return {value};
}

}  // namespace pangaea
