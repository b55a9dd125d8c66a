#include "common/map/atlas_codec.h"

#include "common/map/atlas_decoder.h"
#include "common/map/edits/reference_scale.h"
#include "common/map/frame_pose.h"
#include "common/map/map_bytes.h"

namespace pangaea {
namespace {

void WriteMaps(const Atlas& atlas, MapWriter& writer) {
  std::vector<MapId> closed;
  for (const MapId id : atlas.Maps()) {
    if (atlas.FindMap(id)->closed) closed.push_back(id);
  }
  writer.bytes().Varint(closed.size());
  for (const MapId id : closed) writer.WriteId(id);
  writer.bytes().Varint(atlas.merged_maps().size());
  for (const auto& [absorbed, survivor] : atlas.merged_maps()) {
    writer.WriteId(absorbed);
    writer.WriteId(survivor);
  }
}

void WriteKeyframe(const Keyframe& keyframe, MapWriter& writer) {
  writer.WriteId(keyframe.id);
  writer.WriteId(keyframe.map);
  writer.WriteId(keyframe.parent);
  writer.WriteRigid(keyframe.camera_from_map);
  writer.bytes().Varint(keyframe.corrected_at);
  WriteScale({keyframe.scale}, writer);
  writer.bytes().Varint(keyframe.frames ? keyframe.frames->size() : 0);
  if (!keyframe.frames) return;
  for (const FramePose& frame : *keyframe.frames) {
    writer.WriteId(KeyframeId{frame.session, 0});  // the session alone
    WriteFramePose(frame, writer);
  }
}

void WriteFormerKeyframes(const Atlas& atlas, MapWriter& writer) {
  std::size_t count = 0;
  atlas.ForEachFormerKeyframe([&](KeyframeId, const CulledKeyframe*) { ++count; });
  writer.bytes().Varint(count);
  atlas.ForEachFormerKeyframe([&](KeyframeId id, const CulledKeyframe* culled) {
    writer.WriteId(id);
    writer.WriteId(culled == nullptr ? KeyframeId{} : culled->parent);
    if (culled != nullptr) writer.WriteRigid(culled->parent_from_culled);
  });
}

void WriteLandmark(const Landmark& landmark, MapWriter& writer) {
  writer.WriteId(landmark.id);
  writer.WriteId(landmark.reference);
  writer.WritePoint(landmark.point_in_map);
  writer.bytes().Varint(landmark.observations.size());
  for (const Observation& observation : landmark.observations) {
    writer.WriteId(observation.keyframe);
    writer.bytes().Varint(observation.keypoint);
  }
}

void WriteFormerLandmarks(const Atlas& atlas, MapWriter& writer) {
  std::size_t count = 0;
  atlas.ForEachFormerLandmark([&](LandmarkId, LandmarkId) { ++count; });
  writer.bytes().Varint(count);
  atlas.ForEachFormerLandmark([&](LandmarkId id, LandmarkId absorber) {
    writer.WriteId(id);
    writer.WriteId(absorber);
  });
}

void WriteLoopEdges(const Atlas& atlas, MapWriter& writer) {
  writer.bytes().Varint(atlas.loop_edges().size());
  for (const LoopEdge& edge : atlas.loop_edges()) {
    writer.WriteId(edge.from);
    writer.WriteId(edge.to);
    writer.WriteSimilarity(edge.to_from_from);
  }
}

}  // namespace

std::vector<std::byte> EncodeAtlas(const Atlas& atlas) {
  ByteWriter bytes;
  MapWriter writer(bytes);
  bytes.Word(kAtlasFormat);
  bytes.Varint(atlas.version());
  bytes.Varint(atlas.keyframe_count());
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) { WriteKeyframe(keyframe, writer); });
  WriteFormerKeyframes(atlas, writer);
  WriteMaps(atlas, writer);
  bytes.Varint(atlas.landmark_count());
  atlas.ForEachLandmark([&](const Landmark& landmark) { WriteLandmark(landmark, writer); });
  WriteFormerLandmarks(atlas, writer);
  WriteLoopEdges(atlas, writer);
  return bytes.Take();
}

Result<Atlas> DecodeAtlas(std::span<const std::byte> bytes, const KeyframeDataSource& data) {
  Atlas atlas;
  if (auto status = AtlasDecoder(bytes, data, atlas).Run(); !status) return tl::make_unexpected(status.error());
  return atlas;
}

}  // namespace pangaea
