#include "common/map/frame_correction.h"

#include "common/map/edits/reference_scale.h"

namespace pangaea {

std::optional<FrameCorrection> FrameCorrection::Of(const Keyframe& arrived, const Atlas& atlas) {
  const TrackedArrival& arrival = arrived.data->arrival;
  const auto reference = atlas.ResolvePose(arrival.reference);
  if (!reference || reference->keyframe->map != arrived.map || arrival.reference == arrived.id) return std::nullopt;
  const Keyframe& holder = *reference->keyframe;
  const double factor = LengthFactor(holder, {arrival.reference_scale});
  const Rigid3d tracked_from_holder =
      ScaleLengths(arrival.camera_from_reference, factor) * reference->keyframe_from_asked.Inverse();
  const Rigid3d now_from_holder = arrived.camera_from_map * holder.camera_from_map.Inverse();
  FrameCorrection correction;
  correction.session_ = arrived.id.session;
  correction.holder_ = holder.id;
  correction.since_ns_ = arrival.since_ns;
  correction.until_ns_ = arrived.data->stamp_ns;
  correction.holds_itself_ = holder.id == arrived.id;
  correction.correction_ = (now_from_holder * tracked_from_holder.Inverse()).Log();
  return correction;
}

Rigid3d FrameCorrection::HolderFromFrame(const FramePose& frame) const {
  // Ascending, but their difference need not fit a signed number.
  const auto nanoseconds_since = [this](std::int64_t stamp_ns) {
    return static_cast<double>(static_cast<std::uint64_t>(stamp_ns) - static_cast<std::uint64_t>(since_ns_));
  };
  const double share = nanoseconds_since(frame.stamp_ns) / nanoseconds_since(until_ns_);
  return frame.reference_from_frame * Rigid3d::Exp(-share * correction_);
}

}  // namespace pangaea
