#include "common/place/vocabulary_codec.h"

#include <cstdint>
#include <string>
#include <utility>

#include "common/base/bytes.h"
#include "common/base/hash.h"

namespace pangaea {
namespace {

constexpr std::uint32_t kMagic = 0x54564750;  // the bytes "PGVT" in order
constexpr std::uint64_t kVersion = 1;
// The root takes one byte, any other node at least a centre: so much each on average of two nodes or more.
constexpr std::size_t kLeastNodeBytes = sizeof(Descriptor) / 2;

tl::unexpected<Error> Corrupt(const std::string& reason) { return Fail(ErrorCode::kCorrupt, "vocabulary: " + reason); }

// How many nodes, breadth first, lie above `depth`: those that may have children. `count_of` gives the number of
// children of a node; it is asked for the nodes in order. Stops where there would be more than `most` nodes.
template <typename CountOf>
std::size_t CountUpperNodes(int depth, std::size_t most, CountOf&& count_of) {
  std::size_t level_begin = 0, level_end = 1;
  for (int level = 0; level < depth && level_begin < level_end && level_end <= most; ++level) {
    std::size_t children = 0;
    for (std::size_t node = level_begin; node < level_end; ++node) children += count_of(node);
    level_begin = level_end;
    level_end += children;
  }
  return level_begin;
}

Status CheckFrame(std::span<const std::byte> bytes) {
  ByteReader head(bytes);
  const auto magic = head.Word<std::uint32_t>();
  const std::uint64_t version = head.Varint();
  if (!head.ok() || magic != kMagic) return Corrupt("not a vocabulary file");
  if (version != kVersion) {
    return Fail(ErrorCode::kUnsupported,
                "vocabulary: version " + std::to_string(version) + ", this program reads " + std::to_string(kVersion));
  }
  if (bytes.size() < sizeof(std::uint64_t)) return Corrupt("truncated");
  const auto content = bytes.first(bytes.size() - sizeof(std::uint64_t));
  if (ByteReader(bytes.subspan(content.size())).Word<std::uint64_t>() != Hash64(content)) {
    return Corrupt("truncated or damaged (its checksum is wrong)");
  }
  return {};
}

Descriptor ReadDescriptor(ByteReader& reader) {
  Descriptor descriptor;
  for (std::uint64_t& word : descriptor.words) word = reader.Word<std::uint64_t>();
  return descriptor;
}

int ReadBounded(ByteReader& reader, int largest) {
  const std::uint64_t value = reader.Varint();
  if (value > static_cast<std::uint64_t>(largest)) reader.Invalidate();
  return reader.ok() ? static_cast<int>(value) : 0;
}

}  // namespace

std::vector<std::byte> EncodeVocabulary(const VocabularyLayout& layout) {
  const std::size_t nodes = layout.centres.size();
  ByteWriter writer;
  writer.Word(kMagic);
  writer.Varint(kVersion);
  writer.Varint(static_cast<std::uint64_t>(layout.branching));
  writer.Varint(static_cast<std::uint64_t>(layout.depth));
  writer.Varint(nodes);
  writer.Varint(layout.word_weights.size());
  writer.Word(layout.weight_unit);
  CountUpperNodes(layout.depth, nodes, [&](std::size_t node) {
    writer.Word(layout.child_counts[node]);
    return layout.child_counts[node];
  });
  for (std::size_t node = 1; node < nodes; ++node) {
    for (const std::uint64_t word : layout.centres[node].words) writer.Word(word);
  }
  for (const std::uint16_t weight : layout.word_weights) writer.Word(weight);
  writer.Word(Hash64(writer.bytes()));
  return writer.Take();
}

Result<VocabularyTree> DecodeVocabulary(std::span<const std::byte> bytes) {
  if (Status checked = CheckFrame(bytes); !checked) return tl::make_unexpected(checked.error());
  ByteReader reader(bytes.first(bytes.size() - sizeof(std::uint64_t)));
  reader.Word<std::uint32_t>();  // magic
  reader.Varint();               // version
  VocabularyLayout layout;
  layout.branching = ReadBounded(reader, kMaxVocabularyBranching);
  layout.depth = ReadBounded(reader, kMaxVocabularyDepth);
  const std::size_t nodes = reader.Count(kLeastNodeBytes);
  const std::size_t words = reader.Count(sizeof(std::uint16_t));
  layout.weight_unit = reader.Word<float>();
  if (!reader.ok() || nodes < 2) {
    return Corrupt("its sizes do not fit its length");
  }
  layout.child_counts.resize(nodes, 0);
  CountUpperNodes(layout.depth, nodes, [&](std::size_t node) -> std::size_t {
    return node < nodes ? layout.child_counts[node] = reader.Word<std::uint8_t>() : 0;
  });
  layout.centres.resize(1);
  for (std::size_t node = 1; node < nodes; ++node) layout.centres.push_back(ReadDescriptor(reader));
  for (std::size_t word = 0; word < words; ++word) layout.word_weights.push_back(reader.Word<std::uint16_t>());
  if (!reader.ok() || reader.remaining() != 0) return Corrupt("its sizes do not fit its length");
  return VocabularyTree::Create(std::move(layout));
}

}  // namespace pangaea
