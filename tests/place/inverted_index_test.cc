#include "common/place/inverted_index.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/place/synthetic_places.h"

namespace pangaea {
namespace {

using testing::Random;
using testing::SmallVocabulary;
using testing::SyntheticPlaces;

KeyframeId IdOf(std::size_t place) { return {77, static_cast<std::uint32_t>(place + 1)}; }

// Forty places, each seen by one keyframe.
class InvertedIndexTest : public ::testing::Test {
 protected:
  BagOfWords See(std::size_t place, double share) { return tree_.Bag(places_.Image(place, share, random_)); }
  InvertedIndex Filled() {
    InvertedIndex index(tree_.words());
    for (std::size_t place = 0; place < kPlaces; ++place) index.Add(IdOf(place), See(place, 1.0));
    return index;
  }

  static constexpr std::size_t kPlaces = 40;
  Random random_{5};
  VocabularyTree tree_ = SmallVocabulary();
  SyntheticPlaces places_{kPlaces, 200, random_};
};

TEST_F(InvertedIndexTest, TheKeyframeOfThePlaceSeenAgainComesFirst) {
  const InvertedIndex index = Filled();
  for (std::size_t place = 0; place < kPlaces; ++place) {
    const PlaceCandidates found = index.Query(See(place, 0.8));
    ASSERT_FALSE(found.ranked.empty());
    EXPECT_EQ(found.ranked.front().keyframe, IdOf(place));
    EXPECT_TRUE(std::ranges::is_sorted(found.ranked, std::ranges::greater(), &PlaceCandidate::score));
  }
}

TEST_F(InvertedIndexTest, RemovingUndoesAdding) {
  InvertedIndex index = Filled();
  const BagOfWords query = See(3, 0.7);
  const auto before = index.Query(query);
  for (std::uint32_t i = 0; i < 10; ++i) index.Add({99, i + 1}, See(i, 0.9));
  EXPECT_NE(index.Query(query).ranked, before.ranked);
  for (std::uint32_t i = 0; i < 10; ++i) EXPECT_TRUE(index.Remove({99, 10 - i}));
  const auto after = index.Query(query);
  EXPECT_EQ(after.ranked, before.ranked);
  EXPECT_EQ(after.postings_read, before.postings_read);
  EXPECT_EQ(index.size(), kPlaces);
  EXPECT_EQ(index.Find({99, 1}), nullptr);
  EXPECT_FALSE(index.Remove({99, 1}));
}

TEST_F(InvertedIndexTest, TheOrderOfArrivalDoesNotMatter) {
  std::vector<BagOfWords> bags;
  for (std::size_t place = 0; place < kPlaces; ++place) bags.push_back(See(place, 1.0));
  InvertedIndex forwards(tree_.words()), backwards(tree_.words());
  for (std::size_t i = 0; i < kPlaces; ++i) {
    forwards.Add(IdOf(i), bags[i]);
    backwards.Add(IdOf(kPlaces - 1 - i), bags[kPlaces - 1 - i]);
  }
  const BagOfWords query = See(8, 0.5);
  EXPECT_EQ(forwards.Query(query).ranked, backwards.Query(query).ranked);
}

TEST_F(InvertedIndexTest, AddingAKeyframeAgainReplacesItsBag) {
  InvertedIndex index = Filled();
  const BagOfWords moved = See(1, 1.0);
  index.Add(IdOf(0), moved);
  EXPECT_EQ(index.size(), kPlaces);
  EXPECT_EQ(*index.Find(IdOf(0)), moved);
  EXPECT_NE(index.Query(See(0, 0.9)).ranked.front().keyframe, IdOf(0));
}

TEST_F(InvertedIndexTest, KeyframesThatAreNotAdmittedMakeRoomForOthers) {
  const InvertedIndex index = Filled();
  const PlaceQueryOptions options{.candidates = 5};
  const auto found = index.Query(See(2, 0.9), options, [](const KeyframeId& id) { return id != IdOf(2); });
  EXPECT_EQ(found.ranked.size(), 5U);
  EXPECT_TRUE(std::ranges::none_of(found.ranked, [](const auto& candidate) { return candidate.keyframe == IdOf(2); }));
  EXPECT_TRUE(index.Query(See(2, 0.9), options, [](const KeyframeId&) { return false; }).ranked.empty());
}

TEST_F(InvertedIndexTest, CandidatesBelowTheLeastScoreAreLeftOut) {
  const InvertedIndex index = Filled();
  const BagOfWords query = See(2, 0.9);
  const auto all = index.Query(query, {.candidates = 20});
  ASSERT_GT(all.ranked.size(), 3U);
  const double least = all.ranked[2].score;
  EXPECT_EQ(index.Query(query, {.candidates = 20, .min_score = least}).ranked.size(), 3U);
}

TEST_F(InvertedIndexTest, AWordThatAllKeyframesShowTellsLessThanARareOne) {
  InvertedIndex index(4);
  index.Add(IdOf(0), {{0, 0.5F}, {1, 0.5F}});
  index.Add(IdOf(1), {{0, 0.5F}, {2, 0.5F}});
  for (std::size_t i = 2; i < 20; ++i) index.Add(IdOf(i), {{0, 0.5F}, {3, 0.5F}});
  const auto found = index.Query({{0, 0.7F}, {1, 0.3F}}, {.candidates = 2});
  EXPECT_EQ(found.ranked.front().keyframe, IdOf(0));
  EXPECT_GT(found.ranked.front().score, 3.0 * found.ranked.back().score);
}

TEST_F(InvertedIndexTest, TheBudgetBoundsWhatAQueryReadsAndThePlaceIsStillFound) {
  InvertedIndex index = Filled();
  for (std::uint32_t copy = 1; copy <= 20; ++copy) {
    for (std::size_t place = 1; place < kPlaces; ++place) index.Add({copy, IdOf(place).counter}, See(place, 0.5));
  }
  const BagOfWords query = See(0, 0.8);
  const auto whole = index.Query(query);
  const PlaceQueryOptions bounded{.posting_budget = whole.postings_read / 4};
  const auto found = index.Query(query, bounded);
  EXPECT_LE(found.postings_read, bounded.posting_budget);
  EXPECT_EQ(found.ranked.front(), whole.ranked.front()) << "the score is exact, whatever was read";
}

TEST(PlaceQueryOptions, ImpossibleValuesAreRefused) {
  EXPECT_TRUE(PlaceQueryOptions{}.Check());
  EXPECT_FALSE(PlaceQueryOptions{.candidates = 0}.Check());
  EXPECT_FALSE((PlaceQueryOptions{.candidates = 50, .rescored = 10}.Check()));
  EXPECT_FALSE(PlaceQueryOptions{.min_score = 2.0}.Check());
  EXPECT_FALSE(PlaceQueryOptions{.posting_budget = 0}.Check());
}

}  // namespace
}  // namespace pangaea
