#pragma once

#include "cli/command.h"

namespace pangaea {

// `pangaea vocabulary`: trains a vocabulary from images, describes one, or takes one over from DBoW2.
Command VocabularyCommand();

}  // namespace pangaea
