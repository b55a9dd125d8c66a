#include "common/wire/session_id.h"

#include <random>

namespace pangaea {

SessionId RandomSessionId() {
  std::random_device device;
  std::uniform_int_distribution<SessionId> any(1);
  return any(device);
}

}  // namespace pangaea
