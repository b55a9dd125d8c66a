#include "server/storage/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace pangaea {

Result<FileLock> FileLock::Take(const std::filesystem::path& path) {
  constexpr mode_t kOwnerReadsAndWrites = 0600;
  const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kOwnerReadsAndWrites);
  if (descriptor < 0) return Fail(ErrorCode::kUnavailable, path.string() + ": " + std::strerror(errno));
  FileLock lock(descriptor);
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return lock;
  if (errno == EWOULDBLOCK) return Fail(ErrorCode::kUnavailable, path.string() + ": in use by another process");
  return Fail(ErrorCode::kUnavailable, path.string() + ": " + std::strerror(errno));
}

FileLock::~FileLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace pangaea
