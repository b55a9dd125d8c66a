#pragma once

#include <memory>

#include "common/place/vocabulary_file.h"

namespace pangaea::testing {

// The shipped vocabulary, read once.
inline std::shared_ptr<const VocabularyTree> Vocabulary() {
  static const auto vocabulary = OpenVocabulary().value();
  return vocabulary;
}

}  // namespace pangaea::testing
