#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/rigid3.h"
#include "common/map/atlas.h"

namespace pangaea {

// How the frames between two keyframes share what adjustments have made of the second one since it was tracked. They
// were tracked against the first one, in a map that was not adjusted yet, and drifted from it as the second one did:
// each takes the part of the correction that its time is of the way,
//   frame_from_reference' = Exp(s Log(arrival_now * arrival_tracked^-1)) frame_from_reference, s in (0, 1],
// 1 for the frame that the keyframe was made of, where the map has that as well.
// A value for one keyframe and one state of the atlas.
class FrameCorrection {
 public:
  // Nothing where it was not tracked, or where its reference is in another map by now.
  static std::optional<FrameCorrection> Of(const Keyframe& arrived, const Atlas& atlas);

  // The keyframe that holds the frames that it corrects: its reference, or what that was culled into, which may be the
  // arrived one itself.
  KeyframeId holder() const { return holder_; }
  // When it arrived; it corrects what was tracked by then.
  std::int64_t until_ns() const { return until_ns_; }
  bool Corrects(const FramePose& frame) const {
    if (frame.session != session_ || frame.stamp_ns <= since_ns_) return false;
    return frame.stamp_ns < until_ns_ || (frame.stamp_ns == until_ns_ && !holds_itself_);
  }
  // The frame's pose relative to its holder, for one that it corrects.
  Rigid3d HolderFromFrame(const FramePose& frame) const;

 private:
  FrameCorrection() = default;

  SessionId session_ = 0;
  KeyframeId holder_;
  std::int64_t since_ns_ = 0;
  std::int64_t until_ns_ = 0;
  bool holds_itself_ = false;               // the arrived one is the holder; its own frame is where it is
  Vector6d correction_ = Vector6d::Zero();  // of the arrival, in its camera frame
};

}  // namespace pangaea
