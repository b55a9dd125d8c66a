#pragma once

#include <filesystem>

#include "tests/sensor/temporary_folder.h"

namespace pangaea {

// A place for a store of its own, gone with this object.
class TemporaryStore {
 public:
  std::filesystem::path path() const { return folder_.path() / "atlas.db"; }

 private:
  testing::TemporaryFolder folder_;
};

}  // namespace pangaea
