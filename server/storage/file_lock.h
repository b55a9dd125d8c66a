#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "common/base/result.h"

namespace pangaea {

// An advisory lock held by this process for as long as the object lives; the system releases it when the process
// dies, however it dies. The empty file stays: removing it would let two processes lock different files.
class FileLock {
 public:
  // kUnavailable when another process holds it.
  static Result<FileLock> Take(const std::filesystem::path& path);
  FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileLock& operator=(FileLock&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~FileLock();

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

}  // namespace pangaea
