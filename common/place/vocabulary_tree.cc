#include "common/place/vocabulary_tree.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/base/check.h"
#include "common/base/hash.h"
#include "common/place/vocabulary_codec.h"

namespace pangaea {
namespace {

constexpr double kMaxWeightSteps = 65535.0;

tl::unexpected<Error> NoTree(const std::string& reason) {
  return Fail(ErrorCode::kCorrupt, "not a vocabulary: " + reason);
}

Status CheckBounds(const VocabularyLayout& layout) {
  if (layout.branching < 2 || layout.branching > kMaxVocabularyBranching) {
    return NoTree("a branching of " + std::to_string(layout.branching) + ", allowed are 2 to " +
                  std::to_string(kMaxVocabularyBranching));
  }
  if (layout.depth < 1 || layout.depth > kMaxVocabularyDepth) {
    return NoTree("a depth of " + std::to_string(layout.depth) + ", allowed are 1 to " +
                  std::to_string(kMaxVocabularyDepth));
  }
  if (layout.centres.size() < 2 || layout.centres.size() > kMaxVocabularyNodes) {
    return NoTree(std::to_string(layout.centres.size()) + " nodes, allowed are 2 to " +
                  std::to_string(kMaxVocabularyNodes));
  }
  if (layout.child_counts.size() != layout.centres.size()) return NoTree("nodes without a number of children");
  if (!std::isfinite(layout.weight_unit) || layout.weight_unit < 0.0F) return NoTree("an impossible weight");
  return {};
}

// Walks breadth first, level by level: every node must be the child of one before it, none deeper than the bound.
Status CheckTree(const VocabularyLayout& layout) {
  std::size_t level_begin = 0, level_end = 1, words = 0;
  for (int level = 0; level_begin < level_end; ++level) {
    std::size_t children = 0;
    for (std::size_t node = level_begin; node < level_end; ++node) {
      const std::size_t count = layout.child_counts[node];
      if (count > static_cast<std::size_t>(layout.branching)) return NoTree("a node with too many children");
      words += count == 0 ? 1U : 0U;
      children += count;
    }
    if (children > 0 && level == layout.depth) return NoTree("a word deeper than its depth");
    if (children > layout.centres.size() - level_end) return NoTree("children that are missing");
    level_begin = level_end;
    level_end += children;
  }
  if (level_end != layout.centres.size()) return NoTree("nodes that are no node's children");
  if (words != layout.word_weights.size()) return NoTree("another number of weights than of words");
  return {};
}

BagOfWords CountWords(std::vector<WordId> words, const VocabularyTree& tree) {
  std::ranges::sort(words);
  BagOfWords bag;
  double sum = 0.0;
  for (std::size_t begin = 0, end = 0; begin < words.size(); begin = end) {
    while (end < words.size() && words[end] == words[begin]) ++end;
    const float weight = static_cast<float>(end - begin) * tree.WeightOf(words[begin]);
    if (weight <= 0.0F) continue;  // a word that every image shows says nothing
    bag.push_back({words[begin], weight});
    sum += static_cast<double>(weight);
  }
  for (WordWeight& entry : bag) entry.weight = static_cast<float>(static_cast<double>(entry.weight) / sum);
  return bag;
}

}  // namespace

void SetWordWeights(std::span<const double> weights, VocabularyLayout& layout) {
  const double largest = weights.empty() ? 0.0 : *std::ranges::max_element(weights);
  layout.weight_unit = static_cast<float>(largest / kMaxWeightSteps);
  layout.word_weights.clear();
  for (const double weight : weights) {
    const double steps = layout.weight_unit > 0.0F ? weight / static_cast<double>(layout.weight_unit) : 0.0;
    layout.word_weights.push_back(static_cast<std::uint16_t>(std::clamp(std::nearbyint(steps), 0.0, kMaxWeightSteps)));
  }
}

Result<VocabularyTree> VocabularyTree::Create(VocabularyLayout layout) {
  if (Status checked = CheckBounds(layout); !checked) return tl::make_unexpected(checked.error());
  if (Status checked = CheckTree(layout); !checked) return tl::make_unexpected(checked.error());
  return VocabularyTree(std::move(layout));
}

VocabularyTree::VocabularyTree(VocabularyLayout layout) : layout_(std::move(layout)) {
  first_child_.reserve(nodes());
  std::uint32_t next_child = 1;
  WordId next_word = 0;
  for (const std::uint8_t count : layout_.child_counts) {
    first_child_.push_back(count == 0 ? next_word++ : next_child);
    next_child += count;
  }
  fingerprint_ = Hash64(EncodeVocabulary(layout_));
}

float VocabularyTree::WeightOf(WordId word) const {
  PANGAEA_CHECK(word < words());
  return static_cast<float>(layout_.word_weights[word]) * layout_.weight_unit;
}

std::pair<WordId, std::uint32_t> VocabularyTree::Descend(const Descriptor& descriptor, int level) const {
  std::uint32_t node = 0;
  std::uint32_t node_at_level = 0;
  for (int step = 1; layout_.child_counts[node] > 0; ++step) {
    const std::uint32_t first = first_child_[node];
    const std::uint32_t end = first + layout_.child_counts[node];
    int least = 257;  // more than any two descriptors differ
    for (std::uint32_t child = first; child < end; ++child) {
      const int distance = HammingDistance(descriptor, layout_.centres[child]);
      if (distance >= least) continue;
      least = distance;
      node = child;
    }
    if (step <= level) node_at_level = node;
  }
  return {first_child_[node], node_at_level};
}

std::pair<BagOfWords, DirectIndex> VocabularyTree::Describe(std::span<const Descriptor> descriptors, int level) const {
  std::vector<WordId> words;
  DirectIndex direct_index;
  words.reserve(descriptors.size());
  direct_index.reserve(descriptors.size());
  for (std::uint32_t feature = 0; feature < descriptors.size(); ++feature) {
    const auto [word, node] = Descend(descriptors[feature], level);
    words.push_back(word);
    direct_index.push_back({node, feature});
  }
  std::ranges::sort(direct_index);
  return {CountWords(std::move(words), *this), std::move(direct_index)};
}

}  // namespace pangaea
