#include <gtest/gtest.h>

#include <map>
#include <random>

#include "common/map/edits/point_form.h"
#include "common/map/map_bytes.h"
#include "common/map/map_edit.h"
#include "tests/map/random_edits.h"
#include "tests/map/small_world.h"

namespace pangaea {
namespace {

std::vector<MapEdit> OneOfEachKind() {
  const Rigid3d pose = MakePose(0.3, 0.1, 0.2, 0.3);
  const Similarity3d similarity(1.5, pose.rotation(), pose.translation());
  return {AddKeyframe{K(2), M(1), K(1), pose, MakeData(5, 77), {1.5}},
          AddFramePoses{{{K(2), {5, pose}}, {K(1, kBert), {6, QuantizeFramePose(pose)}}}},
          AddLandmark{L(3), K(2), 4, {0.1, 0.2, 3.0}},
          AddObservation{L(300), K(2), 70000},
          RemoveObservation{L(3), K(2)},
          MoveKeyframes{{{K(2), pose, K(1), {2.5}, 1.25}, {K(70000), pose}}, 12},
          MoveLandmarks{{{L(3), {1.0, 2.0, 3.0}, K(2), {1.0}}}},
          FuseLandmarks{L(3), L(3, kBert)},
          RemoveKeyframe{K(2)},
          RemoveLandmark{L(3)},
          AddLoopEdge{K(1), K(2), similarity},
          MergeMaps{M(1), M(1, kBert), similarity, K(1, kBert), K(1), 17},
          CloseMap{M(1)},
          SetVergence{kAnna, 0.00123}};
}

TEST(MapEditCodec, EveryKindComesBackAsItWas) {
  const auto edits = OneOfEachKind();
  ASSERT_EQ(edits.size(), std::variant_size_v<MapEdit>);
  const auto bytes = EncodeEdits(edits);
  const auto decoded = DecodeEdits(bytes);
  ASSERT_TRUE(decoded) << decoded.error().message;
  ASSERT_EQ(decoded->size(), edits.size());
  for (std::size_t i = 0; i < edits.size(); ++i) EXPECT_EQ((*decoded)[i].index(), edits[i].index());
  EXPECT_EQ(EncodeEdits(*decoded), bytes);
}

TEST(MapEditCodec, FieldsComeBackWithEveryBit) {
  const auto edits = OneOfEachKind();
  const auto decoded = DecodeEdits(EncodeEdits(edits));
  ASSERT_TRUE(decoded);
  const auto& sent = std::get<AddKeyframe>(edits[0]);
  const auto& read = std::get<AddKeyframe>((*decoded)[0]);
  EXPECT_EQ(read.id, sent.id);
  EXPECT_EQ(read.map, sent.map);
  EXPECT_EQ(read.parent, sent.parent);
  EXPECT_TRUE(SameBits(read.camera_from_parent, sent.camera_from_parent));
  EXPECT_EQ(read.data->stamp_ns, sent.data->stamp_ns);
  EXPECT_EQ(read.data->camera, sent.data->camera);
  EXPECT_EQ(read.data->features, sent.data->features);
  const auto& frames = std::get<AddFramePoses>((*decoded)[1]).frames;
  const auto& sent_frames = std::get<AddFramePoses>(edits[1]).frames;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].reference, sent_frames[i].reference);
    EXPECT_EQ(frames[i].pose.stamp_ns, sent_frames[i].pose.stamp_ns);
    EXPECT_TRUE(SameBits(frames[i].pose.reference_from_frame, sent_frames[i].pose.reference_from_frame));
  }
  EXPECT_EQ(std::get<AddObservation>((*decoded)[3]).keypoint, 70000u);
  const auto& moves = std::get<MoveKeyframes>((*decoded)[5]);
  EXPECT_EQ(moves.correction, 12u);
  EXPECT_EQ(moves.keyframes[0].reference, K(1));
  EXPECT_EQ(moves.keyframes[0].reference_scale, ReferenceScale{2.5});
  EXPECT_EQ(moves.keyframes[0].scale, 1.25);
  EXPECT_EQ(std::get<MergeMaps>((*decoded)[11]).correction, 17u);
}

TEST(MapEditCodec, AQuantisedPointTakesHalfTheBytesAndEveryPointComesBackWithEveryBit) {
  const Eigen::Vector3d point(1.23456789012345, -2.3456789, 5.6789012345);
  const Eigen::Vector3d quantised = QuantizePoint(point);
  EXPECT_LT((quantised - point).norm(), 1e-6);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(quantised[i], static_cast<double>(static_cast<float>(point[i])));
  const auto come_back = [](const Eigen::Vector3d& sent, std::size_t& bytes) {
    const MapEdit edit = AddLandmark{L(3), K(2), 4, sent};
    const auto encoded = EncodeEdits(std::span(&edit, 1));
    bytes = encoded.size();
    return std::get<AddLandmark>(DecodeEdits(encoded)->front()).point_in_reference;
  };
  std::size_t full = 0, compact = 0;
  EXPECT_EQ(come_back(point, full), point);
  EXPECT_EQ(come_back(quantised, compact), quantised);
  EXPECT_EQ(compact + 12, full);
}

// Journals written before edits had references, scales and corrections.
TEST(MapEditCodec, TheFirstVersionOfAMoveIsReadAsItWasMeant) {
  ByteWriter bytes;
  MapWriter writer(bytes);
  const Rigid3d pose = MakePose(0.3, 0.1, 0.2, 0.3);
  bytes.Word(MoveKeyframes::kTag);
  bytes.Word(std::uint8_t{1});
  bytes.Varint(1);
  writer.WriteId(K(2));
  writer.WriteRigid(pose);
  ByteReader reader(bytes.bytes());
  const auto decoded = Decode(reader);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(reader.remaining(), 0u);
  const auto& moves = std::get<MoveKeyframes>(*decoded);
  EXPECT_EQ(moves.correction, 0u);
  ASSERT_EQ(moves.keyframes.size(), 1u);
  EXPECT_FALSE(moves.keyframes[0].reference.valid());
  EXPECT_TRUE(SameBits(moves.keyframes[0].camera_from_reference, pose));
}

TEST(MapEditCodec, OneEditByItselfComesBack) {
  for (const MapEdit& edit : OneOfEachKind()) {
    ByteWriter first;
    Encode(edit, first);
    ByteReader reader(first.bytes());
    const auto decoded = Decode(reader);
    ASSERT_TRUE(decoded) << KindName(edit);
    EXPECT_EQ(reader.remaining(), 0u);
    ByteWriter second;
    Encode(*decoded, second);
    EXPECT_TRUE(std::ranges::equal(first.bytes(), second.bytes())) << KindName(edit);
  }
}

// Journals hold these numbers: a kind may get a new version, never another tag or name.
TEST(MapEditCodec, TagsAreAsTheyEverWere) {
  std::map<int, std::string_view> tags;
  for (const MapEdit& edit : OneOfEachKind()) {
    tags[std::visit([](const auto& kind) { return int{kind.kTag}; }, edit)] = KindName(edit);
  }
  const std::map<int, std::string_view> expected = {
      {1, "add_keyframe"},       {2, "add_frame_poses"},  {3, "add_landmark"},   {4, "add_observation"},
      {5, "remove_observation"}, {6, "move_keyframes"},   {7, "move_landmarks"}, {8, "fuse_landmarks"},
      {9, "remove_keyframe"},    {10, "remove_landmark"}, {11, "add_loop_edge"}, {12, "merge_maps"},
      {13, "close_map"},         {14, "set_vergence"}};
  EXPECT_EQ(tags, expected);
}

TEST(MapEditCodec, AKeyframeTakesAtMost41BytesAKeypoint) {
  const auto size = [](std::size_t keypoints) {
    const MapEdit edit = AddKeyframe{K(2), M(1), K(1), {}, MakeData(keypoints)};
    return EncodeEdits(std::span(&edit, 1)).size();
  };
  EXPECT_LE(size(1000) - size(0), 41000u);
  EXPECT_LE(size(0), 160u);
}

TEST(MapEditCodec, ImagesWiderThan16BitsAllowComeBackToo) {
  auto data = std::make_shared<KeyframeData>(*MakeData(3));
  data->camera.width = 4096;
  data->features.keypoints[0].u = QuantizePixel(4000.3);
  const MapEdit edit = AddKeyframe{K(1), M(1), {}, {}, data};
  const auto decoded = DecodeEdits(EncodeEdits(std::span(&edit, 1)));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(std::get<AddKeyframe>(decoded->front()).data->features, data->features);
}

TEST(MapEditCodec, TheLastPixelOfTheWidestImageFor16BitsComesBack) {
  auto data = std::make_shared<KeyframeData>(*MakeData(3));
  data->camera.width = 2047;
  data->features.keypoints[0].u = 2047.0F - kPixelQuantum;
  data->features.keypoints[1].u = 1030.0F;
  const MapEdit edit = AddKeyframe{K(1), M(1), {}, {}, data};
  const auto decoded = DecodeEdits(EncodeEdits(std::span(&edit, 1)));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(std::get<AddKeyframe>(decoded->front()).data->features, data->features);
}

TEST(MapEditCodec, QuantisedFramePosesAreCloseAndStayAsTheyAre) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    Vector6d twist;
    for (double& value : twist) value = uniform(random);
    const Rigid3d pose = Rigid3d::Exp(twist);
    const Rigid3d quantised = QuantizeFramePose(pose);
    EXPECT_LT((pose.Inverse() * quantised).Log().norm(), 1e-6);
    EXPECT_TRUE(SameBits(QuantizeFramePose(quantised), quantised));
  }
}

TEST(MapEditCodec, UnknownKindsVersionsAndFormatsAreSaidToBeSo) {
  const MapEdit edit = RemoveLandmark{L(3)};
  const auto bytes = EncodeEdits(std::span(&edit, 1));  // format, count, tag, version, ...
  for (const std::size_t place : {0, 2, 3}) {
    auto changed = bytes;
    changed[place] = std::byte{99};
    const auto decoded = DecodeEdits(changed);
    ASSERT_FALSE(decoded);
    EXPECT_EQ(decoded.error().code, ErrorCode::kUnsupported) << place;
  }
  auto longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_EQ(DecodeEdits(longer).error().code, ErrorCode::kCorrupt);
}

TEST(MapEditCodec, TruncationAnywhereIsAnError) {
  const auto bytes = EncodeEdits(OneOfEachKind());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(DecodeEdits(std::span(bytes).first(size))) << size;
  }
}

// What comes out of corrupted bytes is an error, or edits that can be sent, applied and refused like any other.
TEST(MapEditCodec, CorruptionNeverDoesHarm) {
  const auto bytes = EncodeEdits(OneOfEachKind());
  std::mt19937_64 random(7);
  int decoded_ones = 0;
  for (int i = 0; i < 20000; ++i) {
    auto corrupt = bytes;
    for (std::uint64_t n = 1 + random() % 3; n > 0; --n) {
      corrupt[random() % corrupt.size()] = static_cast<std::byte>(random());
    }
    const auto decoded = DecodeEdits(corrupt);
    if (!decoded) continue;
    ++decoded_ones;
    EXPECT_TRUE(DecodeEdits(EncodeEdits(*decoded)));
    if (i % 20 != 0) continue;
    SmallWorld world = RowOfThree();
    for (const MapEdit& edit : *decoded) {
      if (Validate(edit, world.atlas)) world.Do(edit);
    }
  }
  EXPECT_GT(decoded_ones, 100);
}

TEST(MapEditCodec, NoiseNeverDoesHarm) {
  std::mt19937_64 random(8);
  for (int i = 0; i < 20000; ++i) {
    std::vector<std::byte> noise(random() % 100);
    for (std::byte& byte : noise) byte = static_cast<std::byte>(random());
    if (noise.size() > 3) {
      noise[0] = std::byte{1};  // deeper into the decoder
      noise[1] = std::byte{1};
      noise[2] = static_cast<std::byte>(1 + random() % 13);
      noise[3] = std::byte{1};
    }
    const auto decoded = DecodeEdits(noise);
    EXPECT_TRUE(!decoded || DecodeEdits(EncodeEdits(*decoded)));
  }
}

}  // namespace
}  // namespace pangaea
