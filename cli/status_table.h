#pragma once

#include <string>

#include "common/base/result.h"
#include "common/wire/atlas_status.h"

namespace pangaea {

// Whether recognition, welding or optimisation are under way, by the status; false for a server that does none of it.
// kCorrupt as below.
Result<bool> IsUnderWay(const AtlasStatus& status);

// The status as lines of text for people. kCorrupt when its JSON does not parse or is of another shape.
Result<std::string> StatusTable(const AtlasStatus& status);

}  // namespace pangaea
