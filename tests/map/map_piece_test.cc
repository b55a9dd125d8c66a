#include "common/map/map_piece.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/map/random_edits.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

// Everything of the first map of a world made at random; every other keyframe is held by the receiver.
MapPiece AnyPiece(std::uint64_t seed) {
  Atlas atlas;
  RandomEdits edits(seed);
  for (int i = 0; i < 300; ++i) (void)Apply(edits.Next(atlas), atlas);
  PieceSelection selection;
  if (!atlas.Maps().empty()) selection.map = atlas.Maps().front();
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    selection.keyframes.push_back(keyframe.id);
    if (keyframe.id.counter % 2 == 0) selection.held.insert(keyframe.id);
  });
  atlas.ForEachLandmark([&](const Landmark& landmark) { selection.landmarks.push_back(landmark.id); });
  atlas.ForEachFormerLandmark([&](LandmarkId id, LandmarkId) { selection.former_landmarks.push_back(id); });
  atlas.ForEachFormerKeyframe([&](KeyframeId id, const CulledKeyframe*) { selection.culled.push_back(id); });
  return CutPiece(atlas, selection);
}

TEST(MapPiece, HoldsWhatWasSelectedAndTellsOfWhatIsGone) {
  SmallWorld world = RowOfThree();
  world.Do(AddLandmark{L(4), K(3), 4, {0, 0, 4}});
  world.Do(FuseLandmarks{L(3), L(4)});
  world.Do(RemoveLandmark{L(1)});
  const MapPiece piece = CutPiece(
      world.atlas, {M(1), {K(3), K(2), K(9)}, {K(2)}, {L(3), L(2), L(1)}, {L(4), L(1), L(2), L(77)}, {K(1), K(88)}});
  ASSERT_EQ(piece.keyframes.size(), 2U);
  EXPECT_EQ(piece.keyframes[0].id, K(2));
  EXPECT_EQ(piece.keyframes[0].data, nullptr);
  EXPECT_EQ(piece.keyframes[1].data, world.Get(K(3)).data);
  ASSERT_EQ(piece.landmarks.size(), 2U);
  EXPECT_EQ(piece.landmarks[0].id, L(2));
  EXPECT_EQ(piece.landmarks[0].observations, world.Get(L(2)).observations);
  EXPECT_EQ(piece.landmarks[0].point_in_map, world.Get(L(2)).point_in_map);
  EXPECT_EQ(piece.fused, (std::vector<FusedLandmark>{{L(4), L(3)}}));
  EXPECT_EQ(piece.removed, (std::vector<LandmarkId>{L(1)}));
  EXPECT_TRUE(piece.culled.empty());
}

TEST(MapPiece, WhatIsLetGoStandsInOrderAmongWhatIsGone) {
  SmallWorld world = RowOfThree();
  world.Root(K(1, kBert), M(1, kBert));
  world.Add(L(1, kBert), K(1, kBert), 1);
  world.Do(RemoveLandmark{L(3)});
  PieceSelection selection;
  selection.map = M(1, kBert);
  selection.former_landmarks = {L(3)};
  selection.released = {K(3), K(2)};
  selection.released_landmarks = {L(2), L(1)};
  const MapPiece piece = CutPiece(world.atlas, selection);
  EXPECT_EQ(piece.removed, (std::vector{L(1), L(2), L(3)}));
  ASSERT_EQ(piece.culled.size(), 2U);
  EXPECT_EQ(piece.culled[0].id, K(2));
  const auto decoded = DecodePieces(EncodePieces({&piece, 1}));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->front().removed, piece.removed);
}

TEST(MapPiece, TellsWhereACulledKeyframeWouldBe) {
  SmallWorld world = RowOfThree();
  const Rigid3d before = world.Get(K(2)).camera_from_map;
  world.Do(RemoveKeyframe{K(2)});
  const MapPiece piece = CutPiece(world.atlas, {M(1), {}, {}, {}, {}, {K(2)}});
  ASSERT_EQ(piece.culled.size(), 1U);
  EXPECT_LT((piece.culled[0].camera_from_map->translation() - before.translation()).norm(), 1e-9);
}

TEST(MapPiece, ALandmarkWhoseReferenceIsNotListedIsMeasuredFromAnother) {
  SmallWorld world = RowOfThree();  // landmark 1 is of keyframe 1, seen by 2 as well
  const MapPiece piece = CutPiece(world.atlas, {M(1), {K(2)}, {}, {L(1)}, {}, {}});
  ASSERT_EQ(piece.landmarks.size(), 1U);
  EXPECT_EQ(piece.landmarks[0].reference, K(2));
  EXPECT_EQ(piece.landmarks[0].observations.size(), 1U);
}

TEST(MapPiece, ComesBackBitByBit) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const std::vector<MapPiece> pieces = {AnyPiece(seed), AnyPiece(seed + 100)};
    const std::vector<std::byte> bytes = EncodePieces(pieces);
    const auto decoded = DecodePieces(bytes);
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(EncodePieces(*decoded), bytes);
    ASSERT_EQ(decoded->size(), 2U);
    EXPECT_EQ(decoded->front().keyframes.size(), pieces.front().keyframes.size());
  }
}

TEST(MapPiece, TruncatedBytesAreAnError) {
  const std::vector<std::byte> bytes = EncodePieces(std::vector{AnyPiece(3)});
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 64) {
    EXPECT_FALSE(DecodePieces(std::span(bytes).first(size)));
  }
}

// What damaged bytes decode to, if anything, is sound: it can be encoded, and decoded again.
TEST(MapPiece, HostileBytesNeverBecomeAnUnsoundPiece) {
  std::mt19937_64 random(7);
  const std::vector<std::byte> good = EncodePieces(std::vector{AnyPiece(3), AnyPiece(5)});
  int decoded_at_all = 0;
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::byte> bytes = good;
    const int flips = 1 + static_cast<int>(random() % 3);
    for (int flip = 0; flip < flips; ++flip) bytes[random() % bytes.size()] = static_cast<std::byte>(random() % 256);
    const auto pieces = DecodePieces(bytes);
    if (!pieces) continue;
    ++decoded_at_all;
    EXPECT_TRUE(DecodePieces(EncodePieces(*pieces)));
  }
  EXPECT_GT(decoded_at_all, 0);
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::byte> noise(random() % 200);
    for (std::byte& byte : noise) byte = static_cast<std::byte>(random() % 256);
    if (!noise.empty()) noise[0] = std::byte{1};
    const auto pieces = DecodePieces(noise);
    if (!pieces) continue;
    EXPECT_TRUE(DecodePieces(EncodePieces(*pieces)));
  }
}

TEST(MapPiece, WhatDoesNotFitTogetherIsAnError) {
  const SmallWorld world = RowOfThree();
  const MapPiece good = CutPiece(world.atlas, {M(1), {K(1), K(2)}, {}, {L(1)}, {}, {}});
  const auto decodes = [&](auto change) {
    MapPiece piece = good;
    change(piece);
    return DecodePieces(EncodePieces(std::vector{piece})).has_value();
  };
  EXPECT_TRUE(decodes([](MapPiece&) {}));
  EXPECT_FALSE(decodes([](MapPiece& p) { p.map = {}; }));
  EXPECT_FALSE(decodes([](MapPiece& p) { std::swap(p.keyframes[0], p.keyframes[1]); }));
  EXPECT_FALSE(decodes([](MapPiece& p) { p.keyframes[0].scale = 0.0; }));
  EXPECT_FALSE(decodes([](MapPiece& p) { p.landmarks[0].observations[0].keyframe = K(3); }));
  EXPECT_FALSE(decodes([](MapPiece& p) { p.landmarks[0].observations[0].keypoint = 20; }));
  EXPECT_FALSE(decodes([](MapPiece& p) { p.landmarks[0].reference = K(3); }));
  EXPECT_FALSE(decodes([](MapPiece& p) { p.landmarks[0].point_in_map.x() = std::nan(""); }));
  EXPECT_FALSE(decodes([](MapPiece& p) { p.fused.push_back({L(5), L(5)}); }));
  EXPECT_FALSE(decodes([](MapPiece& p) { p.culled = {{K(7), {}}, {K(6), {}}}; }));
}

}  // namespace
}  // namespace pangaea
