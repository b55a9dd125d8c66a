#include "common/base/blas_threads.h"

#include <dlfcn.h>

#include <cstdlib>

namespace pangaea {

void UseOneBlasThread() {
  if (std::getenv("OPENBLAS_NUM_THREADS") != nullptr || std::getenv("OMP_NUM_THREADS") != nullptr) return;
  // Looked up at run time: which BLAS is linked is the system's choice.
  using SetThreads = void (*)(int);
  if (const auto set_threads = reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))) {
    set_threads(1);
  }
}

}  // namespace pangaea
