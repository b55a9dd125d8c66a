#pragma once

#include <cstdint>

#include "common/base/result.h"
#include "common/geometry/rigid3.h"

namespace pangaea {

struct Keyframe;
class MapReader;
class MapWriter;

// The `scale` that a keyframe had where a length relative to it was measured. A correction of the server may change it
// while the length is under way, so the length is multiplied by what the scale became since.
struct ReferenceScale {
  double value = 0.0;  // 0: measured on this very atlas, nothing to multiply

  bool operator==(const ReferenceScale&) const = default;
};

// What lengths relative to the keyframe, which had that scale when they were measured, are multiplied by.
double LengthFactor(const Keyframe& reference, ReferenceScale measured_at);
// A factor of one leaves every bit, also those of the rotation.
Rigid3d ScaleLengths(const Rigid3d& rigid, double factor);
Status CheckScale(ReferenceScale scale);
// One byte where the scale is 1 or none.
void WriteScale(ReferenceScale scale, MapWriter& writer);
ReferenceScale ReadScale(MapReader& reader);

}  // namespace pangaea
