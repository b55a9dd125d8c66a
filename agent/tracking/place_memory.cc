#include "agent/tracking/place_memory.h"

#include <algorithm>
#include <utility>

#include "common/base/check.h"
#include "common/map/forgetting.h"

namespace pangaea {

PlaceMemory::PlaceMemory(std::shared_ptr<const VocabularyTree> vocabulary)
    : vocabulary_(std::move(vocabulary)), index_(vocabulary_->words()) {}

void PlaceMemory::Follow(const Atlas& atlas, std::size_t most) {
  if (atlas.version() == followed_version_) return;
  std::erase_if(known_, [&](KeyframeId id) {
    const Keyframe* keyframe = atlas.FindKeyframe(id);
    return (keyframe == nullptr || IsForgotten(*keyframe)) && index_.Remove(id);
  });
  bool complete = true;
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    if (known_.contains(keyframe.id) || IsForgotten(keyframe)) return;
    complete = most > 0;
    if (!complete) return;
    index_.Add(keyframe.id, vocabulary_->Bag(keyframe.data->features.descriptors));
    known_.insert(keyframe.id);
    --most;
  });
  if (complete) followed_version_ = atlas.version();
}

std::vector<KeyframeId> PlaceMemory::Candidates(std::span<const Descriptor> frame, std::size_t count,
                                                const InvertedIndex::Admits& admits) const {
  PlaceQueryOptions options;
  options.candidates = count;
  options.rescored = std::max(options.rescored, count);
  const PlaceCandidates found = index_.Query(vocabulary_->Bag(frame), options, admits);
  std::vector<KeyframeId> candidates;
  for (const PlaceCandidate& candidate : found.ranked) candidates.push_back(candidate.keyframe);
  return candidates;
}

}  // namespace pangaea
