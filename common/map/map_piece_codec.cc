#include <algorithm>
#include <string>
#include <utility>

#include "common/map/keyframe_codec.h"
#include "common/map/limits.h"
#include "common/map/map_bytes.h"
#include "common/map/map_piece.h"
#include "common/map/validation.h"

namespace pangaea {
namespace {

constexpr std::uint8_t kFormat = 1;
constexpr std::size_t kMinIdBytes = 2;
constexpr std::size_t kMinKeyframeBytes = kMinIdBytes + 7 * sizeof(double) + 1 + sizeof(double) + 1;
constexpr std::size_t kMinLandmarkBytes = kMinIdBytes + 3 * sizeof(double) + 2;

void WriteKeyframe(const PieceKeyframe& keyframe, MapWriter& writer) {
  writer.WriteId(keyframe.id);
  writer.WriteRigid(keyframe.camera_from_map);
  writer.bytes().Varint(keyframe.corrected_at);
  writer.bytes().Word(keyframe.scale);
  writer.bytes().Word(static_cast<std::uint8_t>(keyframe.data ? 1 : 0));
  if (keyframe.data) EncodeKeyframeData(*keyframe.data, writer.bytes());
}

PieceKeyframe ReadKeyframe(MapReader& reader) {
  PieceKeyframe keyframe;
  keyframe.id = reader.ReadId<KeyframeTag>();
  keyframe.camera_from_map = reader.ReadRigid();
  keyframe.corrected_at = reader.bytes().Varint();
  keyframe.scale = reader.bytes().Word<double>();
  const auto has_data = reader.bytes().Word<std::uint8_t>();
  if (has_data > 1) reader.bytes().Invalidate();
  if (has_data != 1) return keyframe;
  auto data = DecodeKeyframeData(reader.bytes());
  if (data) keyframe.data = std::move(*data);
  return keyframe;
}

void WriteLandmark(const PieceLandmark& landmark, MapWriter& writer) {
  writer.WriteId(landmark.id);
  writer.WritePoint(landmark.point_in_map);
  writer.WriteId(landmark.reference);
  writer.bytes().Varint(landmark.observations.size());
  for (const Observation& observation : landmark.observations) {
    writer.WriteId(observation.keyframe);
    writer.bytes().Varint(observation.keypoint);
  }
}

PieceLandmark ReadLandmark(MapReader& reader) {
  PieceLandmark landmark;
  landmark.id = reader.ReadId<LandmarkTag>();
  landmark.point_in_map = reader.ReadPoint();
  landmark.reference = reader.ReadId<KeyframeTag>();
  landmark.observations.resize(reader.bytes().Count(kMinIdBytes + 1));
  for (Observation& observation : landmark.observations) {
    observation.keyframe = reader.ReadId<KeyframeTag>();
    observation.keypoint = reader.ReadCounter();
  }
  return landmark;
}

template <typename Tag>
void WriteIds(const std::vector<Id<Tag>>& ids, MapWriter& writer) {
  writer.bytes().Varint(ids.size());
  for (const Id<Tag>& id : ids) writer.WriteId(id);
}

template <typename Tag>
void ReadIds(MapReader& reader, std::vector<Id<Tag>>& ids) {
  ids.resize(reader.bytes().Count(kMinIdBytes));
  for (Id<Tag>& id : ids) id = reader.ReadId<Tag>();
}

void WritePiece(const MapPiece& piece, MapWriter& writer) {
  writer.WriteId(piece.map);
  WriteIds(piece.merged, writer);
  writer.bytes().Varint(piece.keyframes.size());
  for (const PieceKeyframe& keyframe : piece.keyframes) WriteKeyframe(keyframe, writer);
  writer.bytes().Varint(piece.landmarks.size());
  for (const PieceLandmark& landmark : piece.landmarks) WriteLandmark(landmark, writer);
  writer.bytes().Varint(piece.fused.size());
  for (const FusedLandmark& fused : piece.fused) {
    writer.WriteId(fused.absorbed);
    writer.WriteId(fused.kept);
  }
  WriteIds(piece.removed, writer);
  writer.bytes().Varint(piece.culled.size());
  for (const GoneKeyframe& keyframe : piece.culled) {
    writer.WriteId(keyframe.id);
    writer.bytes().Word(static_cast<std::uint8_t>(keyframe.camera_from_map ? 1 : 0));
    if (keyframe.camera_from_map) writer.WriteRigid(*keyframe.camera_from_map);
  }
}

MapPiece ReadPiece(MapReader& reader) {
  MapPiece piece;
  piece.map = reader.ReadId<MapTag>();
  ReadIds(reader, piece.merged);
  piece.keyframes.resize(reader.bytes().Count(kMinKeyframeBytes));
  for (PieceKeyframe& keyframe : piece.keyframes) keyframe = ReadKeyframe(reader);
  piece.landmarks.resize(reader.bytes().Count(kMinLandmarkBytes));
  for (PieceLandmark& landmark : piece.landmarks) landmark = ReadLandmark(reader);
  piece.fused.resize(reader.bytes().Count(2 * kMinIdBytes));
  for (FusedLandmark& fused : piece.fused) {
    fused.absorbed = reader.ReadId<LandmarkTag>();
    fused.kept = reader.ReadId<LandmarkTag>();
  }
  ReadIds(reader, piece.removed);
  piece.culled.resize(reader.bytes().Count(kMinIdBytes + 1));
  for (GoneKeyframe& keyframe : piece.culled) {
    keyframe.id = reader.ReadId<KeyframeTag>();
    const auto has_pose = reader.bytes().Word<std::uint8_t>();
    if (has_pose > 1) reader.bytes().Invalidate();
    if (has_pose == 1) keyframe.camera_from_map = reader.ReadRigid();
  }
  return piece;
}

template <typename Range, typename Key>
bool AscendStrictly(const Range& items, Key key) {
  return std::adjacent_find(items.begin(), items.end(),
                            [&](const auto& a, const auto& b) { return !(key(a) < key(b)); }) == items.end();
}

constexpr auto kItself = [](const auto& id) { return id; };
constexpr auto kId = [](const auto& item) { return item.id; };

template <typename Id>
bool AreIds(const std::vector<Id>& ids) {
  return AscendStrictly(ids, kItself) &&
         std::all_of(ids.begin(), ids.end(), [](const Id& id) { return CheckNewId(id).has_value(); });
}

bool IsCoordinate(const Eigen::Vector3d& vector) { return vector.norm() <= kMaxCoordinate; }  // false for NaN

bool IsSound(const PieceKeyframe& keyframe) {
  const bool scaled = keyframe.scale > 0.0 && keyframe.scale <= kMaxCoordinate;
  return CheckNewId(keyframe.id).has_value() && scaled && IsCoordinate(keyframe.camera_from_map.translation()) &&
         (keyframe.data == nullptr || CheckKeyframeData(*keyframe.data).has_value());
}

bool IsSound(const PieceLandmark& landmark, const MapPiece& piece) {
  const auto listed = [&](const Observation& observation) {
    const auto found = std::lower_bound(piece.keyframes.begin(), piece.keyframes.end(), observation.keyframe,
                                        [](const PieceKeyframe& k, KeyframeId id) { return k.id < id; });
    if (found == piece.keyframes.end() || found->id != observation.keyframe) return false;
    return observation.keypoint < kMaxKeypoints &&
           (found->data == nullptr || observation.keypoint < found->data->features.keypoints.size());
  };
  const auto& observations = landmark.observations;
  const auto keyframe_of = [](const Observation& observation) { return observation.keyframe; };
  const bool referenced =
      observations.empty() ? !landmark.reference.valid()
                           : std::any_of(observations.begin(), observations.end(), [&](const Observation& observation) {
                               return observation.keyframe == landmark.reference;
                             });
  return CheckNewId(landmark.id).has_value() && IsCoordinate(landmark.point_in_map) && referenced &&
         AscendStrictly(observations, keyframe_of) && std::all_of(observations.begin(), observations.end(), listed);
}

bool IsSound(const GoneKeyframe& keyframe) {
  return CheckNewId(keyframe.id).has_value() &&
         (!keyframe.camera_from_map || IsCoordinate(keyframe.camera_from_map->translation()));
}

bool IsSound(const FusedLandmark& fused) {
  return CheckNewId(fused.absorbed).has_value() && CheckNewId(fused.kept).has_value() && fused.absorbed != fused.kept;
}

bool IsSound(const MapPiece& piece) {
  return CheckNewId(piece.map).has_value() && AreIds(piece.merged) && AscendStrictly(piece.keyframes, kId) &&
         std::all_of(piece.keyframes.begin(), piece.keyframes.end(),
                     [](const PieceKeyframe& keyframe) { return IsSound(keyframe); }) &&
         AscendStrictly(piece.landmarks, kId) &&
         std::all_of(piece.landmarks.begin(), piece.landmarks.end(),
                     [&](const PieceLandmark& landmark) { return IsSound(landmark, piece); }) &&
         AscendStrictly(piece.fused, [](const FusedLandmark& fused) { return fused.absorbed; }) &&
         std::all_of(piece.fused.begin(), piece.fused.end(),
                     [](const FusedLandmark& fused) { return IsSound(fused); }) &&
         AreIds(piece.removed) && AscendStrictly(piece.culled, kId) &&
         std::all_of(piece.culled.begin(), piece.culled.end(),
                     [](const GoneKeyframe& keyframe) { return IsSound(keyframe); });
}

}  // namespace

std::vector<std::byte> EncodePieces(std::span<const MapPiece> pieces) {
  ByteWriter bytes;
  MapWriter writer(bytes);
  bytes.Word(kFormat);
  bytes.Varint(pieces.size());
  for (const MapPiece& piece : pieces) WritePiece(piece, writer);
  return bytes.Take();
}

Result<std::vector<MapPiece>> DecodePieces(std::span<const std::byte> bytes) {
  constexpr std::size_t kMinPieceBytes = 8;
  ByteReader byte_reader(bytes);
  MapReader reader(byte_reader);
  const auto format = byte_reader.Word<std::uint8_t>();
  if (byte_reader.ok() && format != kFormat) {
    return Fail(ErrorCode::kUnsupported, "unknown format of map pieces: " + std::to_string(format));
  }
  std::vector<MapPiece> pieces;
  const std::size_t count = byte_reader.Count(kMinPieceBytes);
  for (std::size_t i = 0; i < count && byte_reader.ok(); ++i) pieces.push_back(ReadPiece(reader));
  if (!byte_reader.ok() || byte_reader.remaining() != 0) {
    return Fail(ErrorCode::kCorrupt, "map pieces are truncated or followed by something else");
  }
  const auto sound = [](const MapPiece& piece) { return IsSound(piece); };
  if (std::all_of(pieces.begin(), pieces.end(), sound)) return pieces;
  return Fail(ErrorCode::kCorrupt, "a map piece has impossible ids or numbers");
}

}  // namespace pangaea
