#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/base/descriptor.h"
#include "common/base/result.h"

namespace pangaea {

// The images of a folder and of all folders below it (PNG, JPEG, PGM), by name; of every folder each STEP-th, from
// its first. `source` is FOLDER or FOLDER:STEP. kNotFound where there are none.
Result<std::vector<std::filesystem::path>> ListImages(const std::string& source);

// The descriptors of each image, as agents extract them. An image that cannot be read is an error. `report(done,
// total)` is called after each.
Result<std::vector<std::vector<Descriptor>>> DescribeImages(
    const std::vector<std::filesystem::path>& images, int features,
    const std::function<void(std::size_t, std::size_t)>& report);

}  // namespace pangaea
