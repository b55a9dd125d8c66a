#pragma once

#include <condition_variable>
#include <mutex>

// Clang's thread-safety attributes; nothing under other compilers.
#if defined(__clang__)
#define PANGAEA_THREAD_ANNOTATION(x) __attribute__((x))
#else
#define PANGAEA_THREAD_ANNOTATION(x)
#endif
#define CAPABILITY(x) PANGAEA_THREAD_ANNOTATION(capability(x))
#define SCOPED_CAPABILITY PANGAEA_THREAD_ANNOTATION(scoped_lockable)
#define GUARDED_BY(x) PANGAEA_THREAD_ANNOTATION(guarded_by(x))
#define REQUIRES(...) PANGAEA_THREAD_ANNOTATION(requires_capability(__VA_ARGS__))
#define ACQUIRE(...) PANGAEA_THREAD_ANNOTATION(acquire_capability(__VA_ARGS__))
#define RELEASE(...) PANGAEA_THREAD_ANNOTATION(release_capability(__VA_ARGS__))
#define EXCLUDES(...) PANGAEA_THREAD_ANNOTATION(locks_excluded(__VA_ARGS__))

namespace pangaea {

// std::mutex with the annotations that let clang check who holds it.
class CAPABILITY("mutex") Mutex {
 public:
  void lock() ACQUIRE() { mutex_.lock(); }
  void unlock() RELEASE() { mutex_.unlock(); }

 private:
  std::mutex mutex_;
};

class SCOPED_CAPABILITY MutexLock {
 public:
  explicit MutexLock(Mutex& mutex) ACQUIRE(mutex) : mutex_(mutex) { mutex_.lock(); }
  ~MutexLock() RELEASE() { mutex_.unlock(); }
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;

 private:
  Mutex& mutex_;
};

using ConditionVariable = std::condition_variable_any;

}  // namespace pangaea
