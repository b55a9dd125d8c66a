#pragma once

#include <cstdint>
#include <string_view>

#include "common/base/result.h"
#include "common/map/ids.h"

namespace pangaea {

class Atlas;
class AtlasEditor;
class MapReader;
class MapWriter;

// Each kind of edit is a struct with kTag and kVersion (stable for ever: journals are full of them), kName, and these
// five functions, which the table of map_edit.cc visits:
//   Status Validate(const Kind&, const Atlas&)        whether ApplyValid may be called
//   void ApplyValid(const Kind&, AtlasEditor&)        late edits to what is culled, fused or gone are no errors
//   bool TouchesOnly(const Kind&, SessionId)          whether all it creates, changes or removes is that session's
//   void Encode(const Kind&, MapWriter&)              the newest version of the kind
//   void Decode(MapReader&, version, Kind&)           any version from 1 to kVersion; the reader's ok() says if it was

}  // namespace pangaea
