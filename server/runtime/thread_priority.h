#pragma once

#include <sys/resource.h>

namespace pangaea {

// How much the calling thread stands back for others: 0 to 19. On Linux a nice value concerns one thread alone.
inline void StandBack(int nice) { (void)setpriority(PRIO_PROCESS, 0, nice); }

}  // namespace pangaea
