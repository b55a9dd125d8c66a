#pragma once

#include <span>
#include <string>

#include "common/base/text.h"
#include "common/place/vocabulary_codec.h"

namespace pangaea::testing {

inline constexpr const char* kShippedVocabulary = PANGAEA_SOURCE_DIR "/config/vocabulary.bin";

inline Result<VocabularyTree> ReadShippedVocabulary() {
  const auto bytes = ReadTextFile(kShippedVocabulary);
  if (!bytes) return tl::make_unexpected(bytes.error());
  return DecodeVocabulary(std::as_bytes(std::span(*bytes)));
}

}  // namespace pangaea::testing
