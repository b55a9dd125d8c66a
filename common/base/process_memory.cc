#include "common/base/process_memory.h"

#include <unistd.h>

#include <fstream>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace pangaea {

void ShareHeaps() {
#ifdef __GLIBC__
  mallopt(M_ARENA_MAX, 2);
#endif
}

void ReturnFreeMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

float ResidentMib() {
  std::ifstream file("/proc/self/statm");
  float all = 0.0F;
  float resident = 0.0F;
  file >> all >> resident;
  return resident * static_cast<float>(sysconf(_SC_PAGESIZE)) / (1024.0F * 1024.0F);
}

}  // namespace pangaea
