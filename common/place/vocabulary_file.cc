#include "common/place/vocabulary_file.h"

#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "common/base/check.h"
#include "common/base/text.h"
#include "common/place/vocabulary_codec.h"

extern "C" {
// In shipped_vocabulary.S.
extern const std::byte pangaea_shipped_vocabulary_begin[];
extern const std::byte pangaea_shipped_vocabulary_end[];
}

namespace pangaea {
namespace {

Result<VocabularyTree> ReadVocabulary(const std::string& path) {
  const auto bytes = ReadTextFile(path);
  if (!bytes) return tl::make_unexpected(bytes.error());
  auto tree = DecodeVocabulary(std::as_bytes(std::span(*bytes)));
  if (!tree) return Fail(tree.error().code, path + ": " + tree.error().message);
  return tree;
}

VocabularyTree ShippedVocabulary() {
  auto tree = DecodeVocabulary({pangaea_shipped_vocabulary_begin, pangaea_shipped_vocabulary_end});
  PANGAEA_CHECK(tree.has_value());
  return std::move(*tree);
}

}  // namespace

Result<std::shared_ptr<const VocabularyTree>> OpenVocabulary(const std::string& path) {
  if (path.empty()) return std::make_shared<const VocabularyTree>(ShippedVocabulary());
  auto tree = ReadVocabulary(path);
  if (!tree) return tl::make_unexpected(tree.error());
  return std::make_shared<const VocabularyTree>(std::move(*tree));
}

}  // namespace pangaea
