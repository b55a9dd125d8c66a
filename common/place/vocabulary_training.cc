#include "common/place/vocabulary_training.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "common/place/binary_medians.h"

namespace pangaea {
namespace {

// A node whose children are still to be found, and the descriptors that reached it.
struct OpenNode {
  std::size_t begin = 0;  // into the sample
  std::size_t end = 0;
  int level = 0;
};

// Orders the range by cluster and returns where each cluster begins and, at last, the end.
std::vector<std::size_t> GroupByCluster(std::span<Descriptor> range, const BinaryClusters& clusters) {
  std::vector<std::size_t> bounds(clusters.centres.size() + 1, 0);
  for (const std::uint32_t cluster : clusters.assignment) ++bounds[cluster + 1];
  for (std::size_t c = 1; c < bounds.size(); ++c) bounds[c] += bounds[c - 1];
  std::vector<std::size_t> next = bounds;
  std::vector<Descriptor> grouped(range.size());
  for (std::size_t i = 0; i < range.size(); ++i) grouped[next[clusters.assignment[i]]++] = range[i];
  std::ranges::copy(grouped, range.begin());
  return bounds;
}

class TreeGrowth {
 public:
  TreeGrowth(std::vector<Descriptor> sample, const VocabularyTrainingOptions& options)
      : sample_(std::move(sample)), options_(options), random_(options.seed) {
    layout_.branching = options.branching;
    layout_.depth = options.depth;
    layout_.centres = {{}};
    open_ = {{0, sample_.size(), 0}};
  }

  VocabularyLayout Grow(const std::function<void(std::size_t, std::size_t)>& report) {
    std::size_t done = 0;
    // Nodes are opened, and so numbered, breadth first.
    for (std::size_t node = 0; node < open_.size(); ++node) {
      const OpenNode open = open_[node];
      const std::size_t children = Split(open);
      layout_.child_counts.push_back(static_cast<std::uint8_t>(children));
      if (children > 0) continue;
      done += open.end - open.begin;
      if (report && (done % 100 == 0 || done == sample_.size())) report(done, sample_.size());
    }
    return std::move(layout_);
  }

 private:
  // Appends the children of a node; returns how many.
  std::size_t Split(const OpenNode& open) {
    const std::size_t size = open.end - open.begin;
    if (open.level == options_.depth || (open.level > 0 && size < static_cast<std::size_t>(options_.min_split))) {
      return 0;
    }
    const std::span<Descriptor> range(sample_.data() + open.begin, size);
    const BinaryClusters clusters = ClusterDescriptors(range, {.clusters = options_.branching}, random_);
    if (clusters.centres.size() < 2) return 0;  // nothing to tell apart
    const std::vector<std::size_t> bounds = GroupByCluster(range, clusters);
    for (std::size_t c = 0; c < clusters.centres.size(); ++c) {
      layout_.centres.push_back(clusters.centres[c]);
      open_.push_back({open.begin + bounds[c], open.begin + bounds[c + 1], open.level + 1});
    }
    return clusters.centres.size();
  }

  std::vector<Descriptor> sample_;
  VocabularyTrainingOptions options_;
  std::mt19937_64 random_;
  VocabularyLayout layout_;
  std::vector<OpenNode> open_;
};

std::vector<Descriptor> Join(std::span<const std::vector<Descriptor>> images) {
  std::vector<Descriptor> all;
  for (const auto& image : images) all.insert(all.end(), image.begin(), image.end());
  return all;
}

std::vector<double> InverseDocumentFrequencies(const VocabularyTree& tree,
                                               std::span<const std::vector<Descriptor>> images) {
  std::vector<std::size_t> documents(tree.words(), 0);
  for (const auto& image : images) {
    std::vector<WordId> words;
    for (const Descriptor& descriptor : image) words.push_back(tree.Word(descriptor));
    std::ranges::sort(words);
    words.erase(std::unique(words.begin(), words.end()), words.end());
    for (const WordId word : words) ++documents[word];
  }
  std::vector<double> weights;
  for (const std::size_t count : documents) {
    // A centre that no descriptor reaches any more (its cluster's own went to a sibling of an upper node) counts as
    // one.
    weights.push_back(
        std::log(static_cast<double>(images.size()) / static_cast<double>(std::max<std::size_t>(count, 1))));
  }
  return weights;
}

}  // namespace

Status VocabularyTrainingOptions::Check() const {
  if (branching < 2 || branching > kMaxVocabularyBranching) {
    return Fail(ErrorCode::kInvalidArgument,
                "vocabulary: the branching must be 2 to " + std::to_string(kMaxVocabularyBranching));
  }
  // Small enough that no training makes more nodes than a vocabulary may have.
  if (depth < 1 || depth > kMaxVocabularyDepth || std::pow(branching, depth) > 2e6) {
    return Fail(ErrorCode::kInvalidArgument, "vocabulary: the depth must be 1 to " +
                                                 std::to_string(kMaxVocabularyDepth) +
                                                 ", and branching ^ depth at most 2,000,000 words");
  }
  if (min_split < 2) return Fail(ErrorCode::kInvalidArgument, "vocabulary: min_split must be at least 2");
  return {};
}

Result<VocabularyTree> TrainVocabulary(std::span<const std::vector<Descriptor>> images,
                                       const VocabularyTrainingOptions& options,
                                       const std::function<void(std::size_t, std::size_t)>& report) {
  if (Status checked = options.Check(); !checked) return tl::make_unexpected(checked.error());
  std::vector<Descriptor> sample = Join(images);
  if (sample.empty() || std::ranges::all_of(sample, [&](const auto& one) { return one == sample.front(); })) {
    return Fail(ErrorCode::kInvalidArgument, "vocabulary: the images show nothing to tell apart");
  }
  VocabularyLayout layout = TreeGrowth(std::move(sample), options).Grow(report);
  const auto words = static_cast<std::size_t>(std::ranges::count(layout.child_counts, 0));
  layout.word_weights.assign(words, 0);
  auto tree = VocabularyTree::Create(layout);
  if (!tree) return tree;
  SetWordWeights(InverseDocumentFrequencies(*tree, images), layout);
  return VocabularyTree::Create(std::move(layout));
}

}  // namespace pangaea
