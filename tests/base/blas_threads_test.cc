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

  const int before = count();
  for (const char* variable : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"}) {
    const char* const present = std::getenv(variable);
    if (present != nullptr) GTEST_SKIP() << variable << " is " << present;
    set(2);
    ASSERT_EQ(setenv(variable, "2", 1), 0);
    UseOneBlasThread();
    EXPECT_EQ(count(), 2) << variable;
    ASSERT_EQ(unsetenv(variable), 0);
  }
  UseOneBlasThread();
  EXPECT_EQ(count(), 1);
  set(before);
}

}  // namespace
}  // namespace pangaea
