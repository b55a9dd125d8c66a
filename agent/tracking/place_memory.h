#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <span>
#include <vector>

#include "common/base/descriptor.h"
#include "common/map/atlas.h"
#include "common/place/inverted_index.h"
#include "common/place/vocabulary_tree.h"

namespace pangaea {

// Which keyframes of the agent's atlas look like a frame, whatever map they belong to: the words of all of them (about
// 20 KB a keyframe). Belongs to one thread.
class PlaceMemory {
 public:
  explicit PlaceMemory(std::shared_ptr<const VocabularyTree> vocabulary);

  // Forgets the keyframes that are no longer in the atlas or forgotten there, and learns those that are new: at most
  // `most` of them (about 0.3 ms each), in the order of their ids. The others wait for the next call.
  void Follow(const Atlas& atlas, std::size_t most);

  // The keyframes that look most like the frame, best first. `admits`: which may be among them (empty: all).
  std::vector<KeyframeId> Candidates(std::span<const Descriptor> frame, std::size_t count,
                                     const InvertedIndex::Admits& admits = {}) const;

  std::size_t size() const { return index_.size(); }

 private:
  std::shared_ptr<const VocabularyTree> vocabulary_;
  InvertedIndex index_;
  std::set<KeyframeId> known_;
  std::uint64_t followed_version_ = 0;
};

}  // namespace pangaea
