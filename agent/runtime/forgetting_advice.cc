#include "agent/runtime/forgetting_advice.h"

#include <utility>

namespace pangaea {

std::optional<MapInterest> ForgettingAdvice::NextInterest(const Atlas& snapshot, const Atlas& confirmed,
                                                          KeyframeId reference, std::uint64_t version,
                                                          const DigestClaim& claim) {
  MapInterest interest = InterestOf(session_, snapshot, confirmed, reference, options_);
  interest.applied_version = version;
  interest.claim = claim;
  if (interest == interest_) return std::nullopt;
  interest_ = interest;
  return interest;
}

void ForgettingAdvice::Choose(const Atlas& snapshot, const Atlas& confirmed, KeyframeId reference) {
  auto chosen = ChooseForgotten(snapshot, confirmed, reference, session_, options_);
  MutexLock lock(mutex_);
  forgettable_ = std::move(chosen);
}

std::vector<KeyframeId> ForgettingAdvice::Take() {
  MutexLock lock(mutex_);
  return std::exchange(forgettable_, {});
}

}  // namespace pangaea
