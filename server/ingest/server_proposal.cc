#include "server/ingest/server_proposal.h"

#include <utility>
#include <variant>

#include "common/map/map_edit.h"

namespace pangaea {
namespace {

void Stamp(std::uint64_t position, MapEdit& edit) {
  std::visit(
      [position](auto& kind) {
        if constexpr (requires { kind.correction; }) kind.correction = position;
      },
      edit);
}

}  // namespace

Status ServerDraft::Try(MapEdit edit) {
  Stamp(position_, edit);
  Status status = Apply(edit, atlas_);
  if (status) edits_.push_back(std::move(edit));
  return status;
}

void StampCorrections(std::uint64_t position, std::vector<MapEdit>& edits) {
  for (MapEdit& edit : edits) Stamp(position, edit);
}

}  // namespace pangaea
