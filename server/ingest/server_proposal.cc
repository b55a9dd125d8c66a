#include "server/ingest/server_proposal.h"

#include <variant>

namespace pangaea {

void StampCorrections(std::uint64_t position, std::vector<MapEdit>& edits) {
  for (MapEdit& edit : edits) {
    std::visit(
        [position](auto& kind) {
          if constexpr (requires { kind.correction; }) kind.correction = position;
        },
        edit);
  }
}

}  // namespace pangaea
