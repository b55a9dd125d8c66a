#pragma once

#include <optional>
#include <vector>

#include "agent/uplink/kept_keyframes.h"
#include "common/base/mutex.h"
#include "common/map/atlas.h"
#include "common/wire/map_interest.h"

namespace pangaea {

// What the uplink thread, which knows what the server has for certain, says of the agent's memory: to mapping, what it
// should forget; to the server, what is here and what is wanted.
class ForgettingAdvice {
 public:
  ForgettingAdvice(SessionId session, const KeptKeyframesOptions& options) : session_(session), options_(options) {}

  // The uplink thread alone. `snapshot` is the agent's atlas, `confirmed` what the server has for certain, `reference`
  // what the camera is near to, `version` of the newest correction absorbed. Nothing where the server knows it.
  std::optional<MapInterest> NextInterest(const Atlas& snapshot, const Atlas& confirmed, KeyframeId reference,
                                          std::uint64_t version, const DigestClaim& claim = {});
  // The uplink thread alone.
  void Choose(const Atlas& snapshot, const Atlas& confirmed, KeyframeId reference) EXCLUDES(mutex_);

  // Any thread: what was chosen last and not taken yet.
  std::vector<KeyframeId> Take() EXCLUDES(mutex_);

 private:
  const SessionId session_;
  const KeptKeyframesOptions options_;
  MapInterest interest_;  // the server was told last; the uplink thread's own
  Mutex mutex_;
  std::vector<KeyframeId> forgettable_ GUARDED_BY(mutex_);
};

}  // namespace pangaea
