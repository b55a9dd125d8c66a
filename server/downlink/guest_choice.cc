#include "server/downlink/guest_choice.h"

#include "common/map/covisibility.h"

namespace pangaea {

Status GuestOptions::Check() const {
  if (window >= 1 && new_at_once >= 1 && found_at_once >= 1) return {};
  return Fail(ErrorCode::kInvalidArgument, "window, new_at_once and found_at_once must be at least 1");
}

std::vector<KeyframeId> ChooseGuests(const Atlas& atlas, KeyframeId near, SessionId session,
                                     const GuestOptions& options) {
  std::vector<KeyframeId> guests;
  for (const KeyframeId id : GrowWindow(atlas, atlas.Resolve(near), options.window)) {
    if (guests.size() >= options.wanted) break;
    if (id.session != session) guests.push_back(id);
  }
  return guests;
}

}  // namespace pangaea
