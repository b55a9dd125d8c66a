#pragma once

#include <cstdint>
#include <optional>

#include "common/wire/relocalization.h"

namespace pangaea {

// Where the server found a frame of a lost camera. The keyframe may not be in the agent's atlas yet.
struct PlaceHint {
  KeyframeId keyframe;
  Rigid3d camera_from_keyframe;
};

// What a lost agent asks the server, and which answers it still believes. Stamps of frames are its clock. A value
// without a thread.
class PlaceInquiry {
 public:
  // The number of the request to send about a frame that no map of the agent knows; nothing where it is too early: one
  // request is under way and not older than half a second, or the server has just said that it does not know the place,
  // or that it does: the place is on its way then.
  std::optional<std::uint64_t> Ask(std::int64_t stamp_ns);
  // Where the camera was, if the answer says so and is to a question of this loss.
  std::optional<PlaceHint> Take(const RelocalizationAnswer& answer);
  // The camera is known again: answers that are still under way mean nothing any more.
  void End();

 private:
  std::uint64_t asked_ = 0;               // the newest request
  std::uint64_t ended_ = 0;               // requests up to here are of earlier losses
  std::optional<std::int64_t> asked_ns_;  // when that was; none: nothing was asked in this loss
  bool answered_ = false;                 // that one was
  bool known_ = false;                    // ... or an earlier one since, and the place is on its way
};

}  // namespace pangaea
