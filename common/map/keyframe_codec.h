#pragma once

#include <memory>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/map/keyframe.h"

namespace pangaea {

// What a keyframe saw, without its place in the map: at most 40 bytes a keypoint. Written once to a store, and part of
// the AddKeyframe edit.
void EncodeKeyframeData(const KeyframeData& data, ByteWriter& writer);
Result<std::shared_ptr<const KeyframeData>> DecodeKeyframeData(ByteReader& reader);

}  // namespace pangaea
