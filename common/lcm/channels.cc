#include "common/lcm/channels.h"

namespace pangaea {
namespace {

constexpr std::size_t kMaxName = 63;  // LCM_MAX_CHANNEL_NAME_LENGTH

}  // namespace

Status LcmChannels::Check() const {
  for (const std::string* name : {&images, &calibration, &pose, &tracking_state, &statistics, &right_images}) {
    const bool may_be_empty = name == &right_images;
    if (name->size() <= kMaxName && (may_be_empty || !name->empty())) continue;
    return Fail(ErrorCode::kInvalidArgument, "LCM channel '" + *name + "'; allowed: 1 to 63 characters");
  }
  if (right_images != images) return {};
  return Fail(ErrorCode::kInvalidArgument,
              "the LCM channels of the left and the right images are both '" + images + "'; allowed: two names");
}

}  // namespace pangaea
