#include "common/place/bag_of_words.h"

namespace pangaea {

double Similarity(const BagOfWords& a, const BagOfWords& b) {
  double score = 0.0;
  ForEachCommonWord(a, b, [&](std::size_t, float smaller) { score += static_cast<double>(smaller); });
  return score;
}

}  // namespace pangaea
