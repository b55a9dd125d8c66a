#include "common/map/edits/point_form.h"

#include <cmath>

#include "common/map/map_bytes.h"

namespace pangaea {
namespace {

enum Form : std::uint8_t { kCompact = 0, kFull = 1 };

}  // namespace

Eigen::Vector3d QuantizePoint(const Eigen::Vector3d& point_in_camera) {
  // GCC 12 drops the way to float and back where it vectorises it. What is volatile it has to write and read.
  Eigen::Vector3d quantised;
  for (int i = 0; i < 3; ++i) {
    const volatile float narrow = static_cast<float>(point_in_camera[i]);
    quantised[i] = static_cast<double>(narrow);
  }
  return quantised;
}

void WriteCompactPoint(const Eigen::Vector3d& point, MapWriter& writer) {
  // Not for NaN, which no validation takes, but which has to come back as it was sent all the same.
  const bool compact = QuantizePoint(point) == point;
  writer.bytes().Word(static_cast<std::uint8_t>(compact ? kCompact : kFull));
  if (!compact) return writer.WritePoint(point);
  for (const double value : point) writer.bytes().Word(static_cast<float>(value));
}

Eigen::Vector3d ReadCompactPoint(MapReader& reader) {
  const auto form = reader.bytes().Word<std::uint8_t>();
  if (form > kFull) reader.bytes().Invalidate();
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  if (form == kFull) {
    point = reader.ReadPoint();
    // Each point has one form.
    if (QuantizePoint(point) == point) reader.bytes().Invalidate();
    return point;
  }
  for (double& value : point) value = reader.bytes().Word<float>();
  return point;
}

}  // namespace pangaea
