#include "agent/mapping/guest_rules.h"

#include <utility>

#include "agent/absorption/absorption.h"

namespace pangaea {
namespace {

// False: it is not for this agent to make them one.
bool Orient(const Atlas& atlas, SessionId session, FuseLandmarks& fusion) {
  const bool keeps_own = fusion.kept.session == session;
  const bool absorbs_own = fusion.absorbed.session == session;
  if (!keeps_own && !absorbs_own) return false;
  const bool absorbs_read_only = IsReadOnly(atlas, *atlas.FindLandmark(fusion.absorbed), session);
  const bool keeps_read_only = IsReadOnly(atlas, *atlas.FindLandmark(fusion.kept), session);
  if (!absorbs_own || (keeps_own && absorbs_read_only && !keeps_read_only)) std::swap(fusion.kept, fusion.absorbed);
  return true;
}

}  // namespace

std::vector<MapEdit> RespectOthers(const Atlas& atlas, SessionId session, std::vector<MapEdit> edits) {
  std::vector<MapEdit> allowed;
  for (MapEdit& edit : edits) {
    const auto* observed = std::get_if<AddObservation>(&edit);
    if (observed != nullptr && observed->keyframe.session != session) continue;
    auto* fusion = std::get_if<FuseLandmarks>(&edit);
    if (fusion != nullptr && !Orient(atlas, session, *fusion)) continue;
    allowed.push_back(std::move(edit));
  }
  return allowed;
}

}  // namespace pangaea
