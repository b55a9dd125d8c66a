#include "common/place/vocabulary_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/place/vocabulary_training.h"
#include "tests/place/synthetic_places.h"

namespace pangaea {
namespace {

using testing::Random;
using testing::RandomDescriptor;
using testing::SmallVocabulary;
using testing::SyntheticPlaces;

TEST(Vocabulary, TheSameImagesAndSeedGiveTheSameVocabulary) {
  const VocabularyTree first = SmallVocabulary(7), second = SmallVocabulary(7);
  EXPECT_EQ(first.layout(), second.layout());
  EXPECT_EQ(first.fingerprint(), second.fingerprint());
  EXPECT_NE(first.fingerprint(), SmallVocabulary(8).fingerprint());
}

TEST(Vocabulary, ADescriptorAlwaysGetsTheSameWordAndAWordIsALeaf) {
  const VocabularyTree tree = SmallVocabulary();
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const Descriptor descriptor = RandomDescriptor(random);
    EXPECT_LT(tree.Word(descriptor), tree.words());
    EXPECT_EQ(tree.Word(descriptor), tree.Word(descriptor));
  }
}

TEST(Vocabulary, TheCentreOfAWordMostlyLeadsToIt) {
  const VocabularyTree tree = SmallVocabulary();
  std::size_t words = 0, own = 0;
  for (std::size_t node = 0; node < tree.nodes(); ++node) {
    if (tree.layout().child_counts[node] > 0) continue;
    if (tree.Word(tree.layout().centres[node]) == words) ++own;
    ++words;
  }
  EXPECT_EQ(words, tree.words());
  EXPECT_GT(own, words * 9 / 10);
}

TEST(Vocabulary, ABagIsSortedAndSumsToOne) {
  const VocabularyTree tree = SmallVocabulary();
  Random random(2);
  std::vector<Descriptor> image;
  for (int i = 0; i < 300; ++i) image.push_back(RandomDescriptor(random));
  const BagOfWords bag = tree.Bag(image);
  double sum = 0.0;
  for (const WordWeight& entry : bag) {
    EXPECT_GT(entry.weight, 0.0F);
    sum += static_cast<double>(entry.weight);
  }
  EXPECT_NEAR(sum, 1.0, 1e-5);
  EXPECT_TRUE(std::ranges::is_sorted(bag, std::ranges::less_equal(), &WordWeight::word) || bag.size() < 2);
  std::ranges::reverse(image);
  EXPECT_EQ(tree.Bag(image), bag) << "the order of features tells nothing";
}

TEST(Vocabulary, AnImageWithoutFeaturesHasAnEmptyBagLikeNothing) {
  const VocabularyTree tree = SmallVocabulary();
  Random random(2);
  const std::vector<Descriptor> image = {RandomDescriptor(random)};
  EXPECT_TRUE(tree.Bag({}).empty());
  EXPECT_EQ(Similarity(tree.Bag({}), tree.Bag(image)), 0.0);
}

TEST(Vocabulary, IdenticalImagesScoreOneAndOthersLess) {
  const VocabularyTree tree = SmallVocabulary();
  Random random(11);
  const SyntheticPlaces places(2, 300, random);
  const BagOfWords bag = tree.Bag(places.Image(0, 1.0, random));
  const BagOfWords again = tree.Bag(places.Image(0, 0.8, random));
  const BagOfWords other = tree.Bag(places.Image(1, 1.0, random));
  EXPECT_NEAR(Similarity(bag, bag), 1.0, 1e-5);
  EXPECT_LT(Similarity(bag, again), 1.0);
  EXPECT_GT(Similarity(bag, again), Similarity(bag, other));
  EXPECT_EQ(Similarity(bag, other), Similarity(other, bag));
}

TEST(Vocabulary, AWordThatEveryTrainingImageShowsHasNoWeight) {
  Random random(4);
  const Descriptor everywhere = RandomDescriptor(random);
  std::vector<std::vector<Descriptor>> images;
  std::vector<Descriptor> own;
  for (int i = 0; i < 8; ++i) {
    own.push_back(RandomDescriptor(random));
    images.push_back({everywhere, own.back()});
  }
  const auto tree = TrainVocabulary(images, {.branching = 10, .depth = 1});
  ASSERT_TRUE(tree) << tree.error().message;
  EXPECT_EQ(tree->WeightOf(tree->Word(everywhere)), 0.0F);
  for (const Descriptor& descriptor : own) EXPECT_NEAR(tree->WeightOf(tree->Word(descriptor)), std::log(8.0), 1e-3);
}

TEST(Vocabulary, TheDirectIndexPutsEachFeatureIntoOneNodeOfItsLevel) {
  const VocabularyTree tree = SmallVocabulary(1, 4, 3);
  Random random(9);
  std::vector<Descriptor> image;
  for (int i = 0; i < 200; ++i) image.push_back(RandomDescriptor(random));
  const std::map<int, std::size_t> most_nodes = {{0, 1}, {1, 4}, {2, 16}, {3, 64}};
  for (const auto& [level, most] : most_nodes) {
    const auto [bag, direct_index] = tree.Describe(image, level);
    EXPECT_EQ(bag, tree.Bag(image));
    EXPECT_TRUE(std::ranges::is_sorted(direct_index));
    std::set<std::uint32_t> nodes, features;
    for (const NodeFeature& entry : direct_index) {
      nodes.insert(entry.node);
      features.insert(entry.feature);
    }
    EXPECT_EQ(features.size(), image.size());
    EXPECT_LE(nodes.size(), most) << "level " << level;
    EXPECT_GT(nodes.size(), most / 2) << "level " << level;
  }
}

TEST(Vocabulary, FeaturesOfOneWordShareTheNodesAboveIt) {
  const VocabularyTree tree = SmallVocabulary(1, 4, 3);
  Random random(9);
  std::vector<Descriptor> image;
  for (int i = 0; i < 400; ++i) image.push_back(RandomDescriptor(random));
  const DirectIndex direct_index = tree.Describe(image, 2).second;
  std::map<WordId, std::uint32_t> node_of_word;
  for (const NodeFeature& entry : direct_index) {
    const auto [known, is_new] = node_of_word.try_emplace(tree.Word(image[entry.feature]), entry.node);
    EXPECT_EQ(known->second, entry.node);
  }
  EXPECT_LT(node_of_word.size(), image.size());
}

TEST(VocabularyTraining, ImagesThatShowNothingToTellApartAreRefused) {
  const std::vector<std::vector<Descriptor>> empty, same = {{Descriptor{}}, {Descriptor{}, Descriptor{}}};
  EXPECT_EQ(TrainVocabulary(empty, {}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(TrainVocabulary(same, {}).error().code, ErrorCode::kInvalidArgument);
}

TEST(VocabularyTraining, OptionsBeyondTheBoundsOfAVocabularyAreRefused) {
  EXPECT_TRUE(VocabularyTrainingOptions{}.Check());
  EXPECT_FALSE(VocabularyTrainingOptions{.branching = 1}.Check());
  EXPECT_FALSE(VocabularyTrainingOptions{.branching = 65}.Check());
  EXPECT_FALSE(VocabularyTrainingOptions{.depth = 0}.Check());
  EXPECT_FALSE((VocabularyTrainingOptions{.branching = 10, .depth = 7}.Check()));
  EXPECT_FALSE(VocabularyTrainingOptions{.min_split = 1}.Check());
}

}  // namespace
}  // namespace pangaea
