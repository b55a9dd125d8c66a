#pragma once

#include <string>

#include "common/base/result.h"

namespace pangaea {

// The names of the LCM channels, 1 to 63 characters each.
struct LcmChannels {
  // Carries image_pair_t (stereo) or image_t (monocular). With `right_images` it carries the left image_t of a stereo
  // camera whose right ones come there; they are paired by stamp.
  std::string images = "PANGAEA_IMAGES";
  std::string right_images;  // empty: none
  std::string calibration = "PANGAEA_CALIBRATION";
  // From the agent.
  std::string pose = "PANGAEA_POSE";
  std::string tracking_state = "PANGAEA_TRACKING_STATE";
  std::string statistics = "PANGAEA_STATISTICS";

  Status Check() const;
};

}  // namespace pangaea
