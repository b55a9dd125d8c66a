#include "common/place/bag_of_words.h"

#include <algorithm>

namespace pangaea {

double Similarity(const BagOfWords& a, const BagOfWords& b) {
  double score = 0.0;
  auto left = a.begin();
  auto right = b.begin();
  while (left != a.end() && right != b.end()) {
    if (left->word < right->word) {
      ++left;
    } else if (right->word < left->word) {
      ++right;
    } else {
      score += static_cast<double>(std::min(left->weight, right->weight));
      ++left, ++right;
    }
  }
  return score;
}

}  // namespace pangaea
