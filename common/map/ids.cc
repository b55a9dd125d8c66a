#include "common/map/ids.h"

#include <cstdio>

namespace pangaea {

std::string ToString(SessionId session) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(session));
  return text;
}

}  // namespace pangaea
