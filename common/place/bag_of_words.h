#pragma once

#include <algorithm>
#include <cstddef>
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

// Calls visit(index in a, smaller of the two weights) for each word of both, ascending.
template <typename Visit>
void ForEachCommonWord(const BagOfWords& a, const BagOfWords& b, Visit&& visit) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (a[i].word < b[j].word) {
      ++i;
    } else if (b[j].word < a[i].word) {
      ++j;
    } else {
      visit(i, std::min(a[i].weight, b[j].weight));
      ++i, ++j;
    }
  }
}

// The L1 score 1 - |a - b| / 2 of Galvez-Lopez and Tardos 2012, Eq. (2), from 0 (no common word) to 1 (the same bag).
// As both sum to 1, it is the sum of the smaller weights over the common words (Nister and Stewenius 2006, Eq. (5)).
double Similarity(const BagOfWords& a, const BagOfWords& b);

}  // namespace pangaea
