#pragma once

#include <string_view>

#include "common/base/result.h"
#include "common/place/vocabulary_tree.h"

namespace pangaea {

// Reads a vocabulary of 256-bit descriptors in DBoW2's text form: a line "branching depth scoring weighting", then one
// line per node, "parent is_word 32 bytes weight"; nodes are numbered from 1 in order of their lines, 0 is the root, a
// parent precedes its children. Words are renumbered breadth first. The scoring is ignored: ours is L1; weights are
// taken as they are. kCorrupt with the line where the text is something else. The words mean the same places only if
// the descriptors were made by the same extractor.
Result<VocabularyTree> ImportDbow2(std::string_view text);

}  // namespace pangaea
