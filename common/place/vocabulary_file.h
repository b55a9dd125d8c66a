#pragma once

#include <memory>
#include <string>

#include "common/base/result.h"
#include "common/place/vocabulary_tree.h"

namespace pangaea {

// The vocabulary in a file written by `pangaea vocabulary`; errors name the file. Without a path the shipped one,
// config/vocabulary.bin, which is built into the program: it cannot be missing, and agent and server of one version
// have the same.
Result<std::shared_ptr<const VocabularyTree>> OpenVocabulary(const std::string& path = {});

}  // namespace pangaea
