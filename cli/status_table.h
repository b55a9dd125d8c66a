#pragma once

#include <string>

#include "common/base/result.h"
#include "common/wire/atlas_status.h"

namespace pangaea {

// The status as lines of text for people. kCorrupt when its JSON does not parse or is of another shape.
Result<std::string> StatusTable(const AtlasStatus& status);

}  // namespace pangaea
