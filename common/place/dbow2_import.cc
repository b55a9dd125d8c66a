#include "common/place/dbow2_import.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pangaea {
namespace {

constexpr double kMaxWeight = 1e6;

struct TextNode {
  Descriptor centre;
  double weight = 0.0;
  bool is_word = false;
  std::vector<std::uint32_t> children;
};

struct TextTree {
  int branching = 0;
  int depth = 0;
  std::vector<TextNode> nodes = {{}};  // the root
};

// Takes numbers from a line, one after the other; after the first that is none, ok() is false for good.
class NumberFields {
 public:
  explicit NumberFields(std::string_view line) : rest_(line) {}

  template <typename T>
  T Next() {
    T value{};
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r"), rest_.size()));
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    const bool separate = end == rest_.data() + rest_.size() || std::string_view(" \t\r").find(*end) != rest_.npos;
    if (error != std::errc() || !separate) {
      ok_ = false;
      return T{};
    }
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }
  bool AtEnd() const { return rest_.find_first_not_of(" \t\r") == rest_.npos; }
  bool ok() const { return ok_; }

 private:
  std::string_view rest_;
  bool ok_ = true;
};

tl::unexpected<Error> Wrong(int line, const std::string& expected) {
  return Fail(ErrorCode::kCorrupt, "line " + std::to_string(line) + ": expected " + expected);
}

Status ReadHeader(std::string_view line, TextTree& tree) {
  NumberFields fields(line);
  tree.branching = fields.Next<int>();
  tree.depth = fields.Next<int>();
  fields.Next<int>();  // scoring
  fields.Next<int>();  // weighting: in the weights already
  if (!fields.ok() || !fields.AtEnd()) return Wrong(1, "\"branching depth scoring weighting\"");
  return {};
}

Status ReadNode(std::string_view line, int number, TextTree& tree) {
  NumberFields fields(line);
  const auto parent = fields.Next<std::uint32_t>();
  TextNode node;
  node.is_word = fields.Next<int>() != 0;
  for (std::uint64_t& word : node.centre.words) {
    for (int byte = 0; byte < 8; ++byte) {
      word |= static_cast<std::uint64_t>(fields.Next<std::uint8_t>()) << (8 * byte);
    }
  }
  node.weight = fields.Next<double>();
  if (!fields.ok() || !fields.AtEnd()) return Wrong(number, "\"parent is_word 32 bytes weight\"");
  if (parent >= tree.nodes.size()) return Wrong(number, "a parent among the lines before");
  if (tree.nodes[parent].is_word) return Wrong(number, "a parent that is no word");
  if (!(node.weight >= 0.0 && node.weight <= kMaxWeight)) return Wrong(number, "a weight of 0 to 1,000,000");
  if (tree.nodes.size() == kMaxVocabularyNodes) return Wrong(number, "no more nodes");
  tree.nodes[parent].children.push_back(static_cast<std::uint32_t>(tree.nodes.size()));
  if (tree.nodes[parent].children.size() > static_cast<std::size_t>(kMaxVocabularyBranching)) {
    return Wrong(number, "no more than " + std::to_string(kMaxVocabularyBranching) + " children of a node");
  }
  tree.nodes.push_back(std::move(node));
  return {};
}

Result<TextTree> ReadLines(std::string_view text) {
  TextTree tree;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (number > 1 && line.find_first_not_of(" \t\r") == line.npos) continue;
    const Status read = number == 1 ? ReadHeader(line, tree) : ReadNode(line, number, tree);
    if (!read) return tl::make_unexpected(read.error());
  }
  return tree;
}

}  // namespace

Result<VocabularyTree> ImportDbow2(std::string_view text) {
  const auto tree = ReadLines(text);
  if (!tree) return tl::make_unexpected(tree.error());
  VocabularyLayout layout;
  layout.branching = tree->branching;
  layout.depth = tree->depth;
  std::vector<double> weights;
  std::vector<std::uint32_t> breadth_first = {0};
  for (std::size_t i = 0; i < breadth_first.size(); ++i) {
    const TextNode& node = tree->nodes[breadth_first[i]];
    layout.centres.push_back(node.centre);
    layout.child_counts.push_back(static_cast<std::uint8_t>(node.children.size()));
    if (node.children.empty()) weights.push_back(node.weight);
    breadth_first.insert(breadth_first.end(), node.children.begin(), node.children.end());
  }
  SetWordWeights(weights, layout);
  return VocabularyTree::Create(std::move(layout));
}

}  // namespace pangaea
