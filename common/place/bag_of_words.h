#pragma once

#include <cstdint>
#include <vector>

namespace pangaea {

// A word of the vocabulary: a leaf of its tree, 0 to words - 1.
using WordId = std::uint32_t;

struct WordWeight {
  WordId word = 0;
  float weight = 0.0F;  // term frequency times inverse document frequency, as a share of the bag's sum
  bool operator==(const WordWeight&) const = default;
};

// What an image shows, in words: ascending by word, weights positive, their sum 1 (or no word at all). Bags are
// comparable where they come from the same vocabulary.
using BagOfWords = std::vector<WordWeight>;

// The L1 score 1 - |a - b| / 2 of Galvez-Lopez and Tardos 2012, Eq. (2), from 0 (no common word) to 1 (the same bag).
// As both sum to 1, it is the sum of the smaller weights over the common words (Nister and Stewenius 2006, Eq. (5)).
double Similarity(const BagOfWords& a, const BagOfWords& b);

}  // namespace pangaea
