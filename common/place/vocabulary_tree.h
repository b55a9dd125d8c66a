#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/base/descriptor.h"
#include "common/base/result.h"
#include "common/place/bag_of_words.h"

namespace pangaea {

// Bounds of any vocabulary: wide enough for the largest in use (a million words), narrow enough for hostile files.
inline constexpr int kMaxVocabularyBranching = 64;
inline constexpr int kMaxVocabularyDepth = 12;
inline constexpr std::size_t kMaxVocabularyNodes = std::size_t{1} << 22;

// A vocabulary tree as plain arrays, breadth first: node 0 is the root, the children of each node follow each other,
// after those of all nodes before it.
struct VocabularyLayout {
  int branching = 10;                       // most children of a node, 2 to kMaxVocabularyBranching
  int depth = 5;                            // most steps from the root to a word, 1 to kMaxVocabularyDepth
  std::vector<Descriptor> centres;          // one per node; the root's is zero
  std::vector<std::uint8_t> child_counts;   // one per node; 0 makes it a word
  std::vector<std::uint16_t> word_weights;  // of the words in order of their nodes, in units of weight_unit
  float weight_unit = 0.0F;                 // 0 where all weights are 0

  bool operator==(const VocabularyLayout&) const = default;
};

// Inverse document frequencies as 16-bit multiples of a common unit, as layouts hold them: the error is below
// max / 131,000. `weights` are finite and >= 0.
void SetWordWeights(std::span<const double> weights, VocabularyLayout& layout);

// Which nodes an image's features passed at one level of the tree, ascending: the direct index of Galvez-Lopez and
// Tardos 2012, section IV. Features of two images that show the same corner mostly share the node.
struct NodeFeature {
  std::uint32_t node = 0;
  std::uint32_t feature = 0;  // index into the descriptors
  auto operator<=>(const NodeFeature&) const = default;
};
using DirectIndex = std::vector<NodeFeature>;

// A hierarchical vocabulary over binary descriptors (Nister and Stewenius 2006; binary: Galvez-Lopez and Tardos 2012).
// Immutable: any number of threads may read one.
class VocabularyTree {
 public:
  // kCorrupt with a reason where the layout is not a tree within the bounds above, or a weight is impossible.
  static Result<VocabularyTree> Create(VocabularyLayout layout);

  std::size_t words() const { return layout_.word_weights.size(); }
  std::size_t nodes() const { return layout_.centres.size(); }
  int branching() const { return layout_.branching; }
  int depth() const { return layout_.depth; }
  const VocabularyLayout& layout() const { return layout_; }
  // Of the whole content: bags and nodes of vocabularies with different fingerprints must not meet.
  std::uint64_t fingerprint() const { return fingerprint_; }

  // The inverse document frequency with which the vocabulary was trained.
  float WeightOf(WordId word) const;
  // From the root always to the child whose centre differs in the fewest bits; of equals the first.
  WordId Word(const Descriptor& descriptor) const { return Descend(descriptor, 0).first; }

  BagOfWords Bag(std::span<const Descriptor> descriptors) const { return Describe(descriptors, 0).first; }
  // The bag and, from the same descent, the direct index at `level` steps below the root (0: all in one node; beyond a
  // word: the word's node). Level 2 of a tree with branching 10 splits 1,000 features into groups of about 10.
  std::pair<BagOfWords, DirectIndex> Describe(std::span<const Descriptor> descriptors, int level) const;

 private:
  explicit VocabularyTree(VocabularyLayout layout);
  // The word, and the node passed at `level`.
  std::pair<WordId, std::uint32_t> Descend(const Descriptor& descriptor, int level) const;

  VocabularyLayout layout_;
  std::vector<std::uint32_t> first_child_;  // of inner nodes; of words: the WordId
  std::uint64_t fingerprint_ = 0;
};

}  // namespace pangaea
