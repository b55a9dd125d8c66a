#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/place/vocabulary_tree.h"

namespace pangaea {

// Our own compact form of a vocabulary (of a layout that is a tree), little-endian:
//   "PGVT" · version, branching, depth, nodes, words (varints) · unit of the weights (float)
//   · the number of children of each node above `depth`, breadth first (1 each: deeper nodes have none)
//   · centres of all nodes but the root (32 each) · weights of all words (2 each) · XXH3 of all before (8).
std::vector<std::byte> EncodeVocabulary(const VocabularyLayout& layout);

// Any bytes: what is no vocabulary gives kCorrupt, a later version kUnsupported. Allocates no more than a few times the
// size of `bytes`.
Result<VocabularyTree> DecodeVocabulary(std::span<const std::byte> bytes);

}  // namespace pangaea
