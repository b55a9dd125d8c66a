#include "common/base/blas_threads.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <thread>

namespace pangaea {
namespace {

using Count = int (*)();

TEST(BlasThreads, ThereIsOneUnlessTheUserAsksForMore) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core has one thread in any case";
  void* const blas = dlopen("libopenblas.so.0", RTLD_NOW | RTLD_GLOBAL);
  if (blas == nullptr) GTEST_SKIP() << dlerror();
  const auto count = reinterpret_cast<Count>(dlsym(blas, "openblas_get_num_threads"));
  const auto set = reinterpret_cast<void (*)(int)>(dlsym(blas, "openblas_set_num_threads"));
  ASSERT_NE(count, nullptr);
  ASSERT_NE(set, nullptr);

  set(2);
  ASSERT_EQ(setenv("OPENBLAS_NUM_THREADS", "2", 1), 0);
  UseOneBlasThread();
  EXPECT_EQ(count(), 2);
  ASSERT_EQ(unsetenv("OPENBLAS_NUM_THREADS"), 0);
  UseOneBlasThread();
  EXPECT_EQ(count(), 1);
}

}  // namespace
}  // namespace pangaea
