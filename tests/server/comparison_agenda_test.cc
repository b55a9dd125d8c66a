#include "server/atlas/comparison_agenda.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/map/small_world.h"

namespace pangaea {
namespace {

using Pair = std::pair<MapId, MapId>;

class ComparisonAgendaTest : public ::testing::Test {
 protected:
  // One more keyframe in a map, which it begins where it is the first.
  void Grow(MapId map, int keyframes = 1) {
    for (int i = 0; i < keyframes; ++i) {
      std::uint32_t& newest = newest_[map.session];
      const KeyframeId id = K(++newest, map.session);
      if (world_.atlas.FindMap(map) == nullptr) {
        world_.Root(id, map);
      } else {
        world_.Child(id, world_.atlas.FindMap(map)->root, map);
      }
    }
  }
  std::vector<Pair> Due(const std::function<bool(MapId)>& is_left = [](MapId) { return false; }) {
    agenda_.Update(world_.atlas, is_left);
    std::vector<Pair> pairs;
    while (const auto pair = agenda_.Next(world_.atlas)) pairs.push_back(*pair);
    return pairs;
  }

  SmallWorld world_;
  ComparisonAgenda agenda_{{.min_keyframes = 3}};

 private:
  std::map<SessionId, std::uint32_t> newest_;
};

TEST_F(ComparisonAgendaTest, AMapIsComparedOnceWithThoseThatAreOverWhenItIs) {
  Grow(M(1), 3);
  Grow(M(1, kBert), 3);
  Grow(M(2, kBert), 3);
  EXPECT_TRUE(Due().empty()) << "they grow";
  world_.Do(CloseMap{M(1, kBert)});
  EXPECT_TRUE(Due().empty()) << "the others grow";
  world_.Do(CloseMap{M(1)});
  EXPECT_EQ(Due(), (std::vector<Pair>{{M(1), M(1, kBert)}}));
  EXPECT_TRUE(Due().empty()) << "once";
}

TEST_F(ComparisonAgendaTest, AMapThatItsAgentLeftWithoutAWordIsOverToo) {
  Grow(M(1), 3);
  Grow(M(1, kBert), 3);
  world_.Do(CloseMap{M(1, kBert)});
  EXPECT_EQ(Due([](MapId map) { return map == M(1); }), (std::vector<Pair>{{M(1), M(1, kBert)}}));
}

TEST_F(ComparisonAgendaTest, TwoThatAreOverAtOnceAreComparedOnce) {
  Grow(M(1), 3);
  Grow(M(1, kBert), 3);
  EXPECT_EQ(Due([](MapId) { return true; }).size(), 1u);
}

TEST_F(ComparisonAgendaTest, SmallMapsAreNotCompared) {
  Grow(M(1), 3);
  Grow(M(1, kBert), 2);
  world_.Do(CloseMap{M(1, kBert)});
  EXPECT_TRUE(Due().empty());
}

TEST_F(ComparisonAgendaTest, WhatGrewAndIsOverAgainIsComparedAgain) {
  Grow(M(1), 3);
  Grow(M(1, kBert), 5);
  world_.Do(CloseMap{M(1, kBert)});
  const auto annas_is_left = [](MapId map) { return map == M(1); };
  EXPECT_EQ(Due(annas_is_left).size(), 1u);
  Grow(M(1));
  EXPECT_TRUE(Due().empty()) << "its agent is back";
  EXPECT_EQ(Due(annas_is_left).size(), 1u);
}

TEST_F(ComparisonAgendaTest, WhatCameInPlaceOfWhatWasCulledIsGrowth) {
  Grow(M(1), 5);
  Grow(M(1, kBert), 5);
  const auto all = [](MapId) { return true; };
  EXPECT_EQ(Due(all).size(), 1u);
  world_.Do(RemoveKeyframe{K(4)});
  world_.Do(RemoveKeyframe{K(5)});
  EXPECT_TRUE(Due(all).empty());
  Grow(M(1));
  EXPECT_EQ(Due(all).size(), 1u);
}

TEST_F(ComparisonAgendaTest, AJoinedMapIsOverWhenItsLastAgentIsGoneWhateverItsPartsSaid) {
  Grow(M(1), 3);
  Grow(M(1, kBert), 3);
  Grow(M(2, kBert), 3);
  for (const MapId map : {M(1), M(1, kBert), M(2, kBert)}) world_.Do(CloseMap{map});
  world_.Do(MergeMaps{M(1), M(1, kBert), {}, K(1, kBert), K(1), 1});
  EXPECT_TRUE(Due().empty()) << "somebody works on it";
  EXPECT_EQ(Due([](MapId map) { return map == M(1); }), (std::vector<Pair>{{M(1), M(2, kBert)}}));
}

TEST_F(ComparisonAgendaTest, OfWhatWasRecoveredClosedMapsAreNotComparedWithEachOther) {
  Grow(M(1), 3);
  Grow(M(2), 3);
  Grow(M(3), 3);
  world_.Do(CloseMap{M(1)});
  world_.Do(CloseMap{M(2)});
  agenda_.Recover(world_.atlas);
  EXPECT_TRUE(Due().empty());
  EXPECT_EQ(Due([](MapId) { return true; }), (std::vector<Pair>{{M(3), M(1)}, {M(3), M(2)}}));
}

TEST_F(ComparisonAgendaTest, WhatIsWorkedOnAgainIsLeftOut) {
  Grow(M(1), 3);
  Grow(M(1, kBert), 3);
  agenda_.Update(world_.atlas, [](MapId) { return true; });
  EXPECT_EQ(agenda_.waiting(), 1u);
  EXPECT_TRUE(Due().empty()) << "both have agents again";
}

TEST_F(ComparisonAgendaTest, MapsThatWereJoinedMeanwhileAreLeftOut) {
  Grow(M(1), 3);
  Grow(M(1, kBert), 3);
  agenda_.Update(world_.atlas, [](MapId) { return true; });
  EXPECT_EQ(agenda_.waiting(), 1u);
  world_.Do(MergeMaps{M(1), M(1, kBert), {}, K(1, kBert), K(1), 1});
  EXPECT_FALSE(agenda_.Next(world_.atlas));
}

TEST(MapsInWork, AreThoseOfSessionsWhoseAgentsLive) {
  SmallWorld world = RowOfThree();
  world.Root(K(1, kBert), M(1, kBert));
  IngestState state;
  for (const SessionId id : {kAnna, kBert}) {
    SessionRecord record;
    record.announcement.session = id;
    state.sessions.emplace(id, IngestSession(std::move(record)));
  }
  state.atlas = world.atlas;
  EXPECT_TRUE(MapsInWork(state).empty()) << "both are known from the store alone";
  SessionAnnouncement anna = state.sessions.at(kAnna).record().announcement;
  ASSERT_TRUE(state.sessions.at(kAnna).Announce(anna, {1, 100}));
  EXPECT_EQ(MapsInWork(state), std::set{M(1)});
  anna.closed = true;
  ASSERT_TRUE(state.sessions.at(kAnna).Announce(anna, {1, 100}));
  EXPECT_TRUE(MapsInWork(state).empty());
}

}  // namespace
}  // namespace pangaea
