#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/map/keyframe_codec.h"

namespace pangaea {

// The whole atlas, forwarding and version included, without the keyframes' data.
std::vector<std::byte> EncodeAtlas(const Atlas& atlas);
// Gives the data of a keyframe, from where it was stored.
using KeyframeDataSource = std::function<Result<std::shared_ptr<const KeyframeData>>(KeyframeId)>;
// Bit for bit what was encoded. kCorrupt for bytes that are no consistent atlas; the source's error where it fails.
Result<Atlas> DecodeAtlas(std::span<const std::byte> bytes, const KeyframeDataSource& data);

}  // namespace pangaea
