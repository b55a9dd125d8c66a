#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "common/base/result.h"
#include "common/map/ids.h"
#include "common/place/bag_of_words.h"

namespace pangaea {

struct PlaceQueryOptions {
  // Candidates wanted at most. Geometric verification costs milliseconds each.
  std::size_t candidates = 10;
  // Candidates below this score are not worth verifying.
  double min_score = 0.0;
  // Postings read at most. Words are taken rarest first, so that it is the words which many keyframes show, and which
  // tell least, that are left out: the cost of a query is bounded, however large the atlas. 2,000 keyframes of 1,000
  // features are read in full.
  std::size_t posting_budget = 200000;
  // So many of the best by the words read get their exact score before the candidates are chosen.
  std::size_t rescored = 100;

  Status Check() const;
};

struct PlaceCandidate {
  KeyframeId keyframe;
  double score = 0.0;  // exact; see InvertedIndex::Query
  bool operator==(const PlaceCandidate&) const = default;
};

struct PlaceCandidates {
  std::vector<PlaceCandidate> ranked;  // best first; of equals the smaller id
  std::size_t postings_read = 0;       // what the query cost
};

// Which keyframes show which words: finds the keyframes whose bags are most like a given one. Keeps the bags (about 16
// bytes a word and keyframe). One owner; results depend on what is in the index, not on the order of its arrival.
class InvertedIndex {
 public:
  // `words`: of the vocabulary all bags come from.
  explicit InvertedIndex(std::size_t words) : postings_(words) {}

  // A keyframe that is in the index already gets its new bag.
  void Add(const KeyframeId& keyframe, BagOfWords bag);
  // False where it was not in the index.
  bool Remove(const KeyframeId& keyframe);
  std::size_t size() const { return slots_.size(); }
  std::vector<KeyframeId> Keyframes() const;  // ascending
  // nullptr where the keyframe is not in the index. Valid until the next Add or Remove.
  const BagOfWords* Find(const KeyframeId& keyframe) const;

  // The keyframes most like `bag`. The score is the L1 score (Similarity) in which each common word counts by its
  // rarity in this index, 0 to 1: what a whole room is made of says little about where in it one is, and the
  // vocabulary, trained elsewhere, cannot know it. So the score is below 1 even for the same bag. `admits`: which
  // keyframes may be candidates (not the query's own neighbours, for example); asked for the best alone, until there
  // are enough. Empty: all.
  using Admits = std::function<bool(const KeyframeId&)>;
  PlaceCandidates Query(const BagOfWords& bag, const PlaceQueryOptions& options = {}, const Admits& admits = {}) const;

 private:
  // A keyframe's place in `documents_`; freed slots are used again.
  using Slot = std::uint32_t;
  struct Posting {
    Slot slot = 0;
    float weight = 0.0F;
  };
  struct Document {
    KeyframeId keyframe;
    BagOfWords bag;
  };

  std::vector<float> Rarities(const BagOfWords& bag) const;
  std::vector<float> Accumulate(const BagOfWords& bag, const std::vector<float>& rarities, std::size_t budget,
                                std::size_t& postings_read) const;
  std::vector<Slot> BestSlots(const std::vector<float>& scores, std::size_t count, const Admits& admits) const;

  std::vector<std::vector<Posting>> postings_;  // by word
  std::vector<Document> documents_;             // by slot
  std::vector<Slot> free_slots_;
  std::unordered_map<KeyframeId, Slot> slots_;
};

}  // namespace pangaea
