#include "server/ingest/envelope_judgement.h"

#include "common/map/map_edit.h"

namespace pangaea {
namespace {

RejectionReason ReasonOfHeader(ErrorCode code) {
  switch (code) {
    case ErrorCode::kUnsupported:
      return RejectionReason::kUnknownWireVersion;
    case ErrorCode::kCorrupt:
      return RejectionReason::kChecksum;
    default:
      return RejectionReason::kTooLarge;
  }
}

std::string Place(std::size_t index, const MapEdit& edit) {
  return "edit " + std::to_string(index + 1) + " (" + std::string(KindName(edit)) + "): ";
}

}  // namespace

tl::expected<std::vector<MapEdit>, Refusal> JudgeContent(const Envelope& envelope) {
  if (const auto header = CheckEnvelope(envelope); !header) {
    return tl::make_unexpected(Refusal{ReasonOfHeader(header.error().code), header.error().message});
  }
  auto edits = DecodeEdits(envelope.edits);
  if (!edits) return tl::make_unexpected(Refusal{RejectionReason::kMalformed, edits.error().message});
  for (std::size_t i = 0; i < edits->size(); ++i) {
    if (TouchesOnly((*edits)[i], envelope.session)) continue;
    return tl::make_unexpected(
        Refusal{RejectionReason::kForeignSession, Place(i, (*edits)[i]) + "changes what belongs to another session"});
  }
  return std::move(*edits);
}

tl::expected<Atlas, Refusal> ApplyWhole(const std::vector<MapEdit>& edits, const Atlas& atlas, ApplyOne apply) {
  Atlas changed = atlas;
  for (std::size_t i = 0; i < edits.size(); ++i) {
    const auto applied = apply(edits[i], changed);
    if (applied) continue;
    const bool unknown = applied.error().code == ErrorCode::kNotFound;
    return tl::make_unexpected(Refusal{unknown ? RejectionReason::kUnknownReference : RejectionReason::kInvalid,
                                       Place(i, edits[i]) + applied.error().message});
  }
  return changed;
}

}  // namespace pangaea
