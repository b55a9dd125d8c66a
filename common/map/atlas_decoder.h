#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/map/atlas_codec.h"
#include "common/map/atlas_editor.h"
#include "common/map/covisibility_count.h"
#include "common/map/map_bytes.h"

namespace pangaea {

// First byte of an encoded atlas. Format 1 has no corrections and scales of keyframes; both are read for ever.
inline constexpr std::uint8_t kAtlasFormat = 2;

// Builds an atlas from the bytes of EncodeAtlas, part by part in their order, and believes none of them: each part is
// checked against those before it, so that what is built is consistent. Run once, on an empty atlas.
class AtlasDecoder {
 public:
  AtlasDecoder(std::span<const std::byte> bytes, const KeyframeDataSource& data, Atlas& atlas)
      : bytes_(bytes), reader_(bytes_), data_(data), atlas_(atlas), editor_(atlas) {}

  Status Run();

 private:
  using ByParent = std::map<KeyframeId, std::vector<Keyframe>>;

  Status ReadKeyframes();
  Result<Keyframe> ReadKeyframe();
  Status ReadFrames(Keyframe& keyframe);
  Status InsertTrees(ByParent& by_parent);
  Status ReadFormerKeyframes();
  Status ReadMaps();
  Status ReadLandmarks();
  Status ReadLandmark();
  Status InsertLandmark(Landmark landmark);
  Status ReadFormerLandmarks();
  Status ReadLoopEdges();

  ByteReader bytes_;
  MapReader reader_;
  const KeyframeDataSource& data_;
  Atlas& atlas_;
  AtlasEditor editor_;
  CovisibilityCount covisibility_;  // of the landmarks read so far
  std::uint8_t format_ = kAtlasFormat;
};

}  // namespace pangaea
