#include "agent/runtime/uplink_endpoints.h"

#include <utility>

namespace pangaea {

Result<UplinkEndpoints> OpenUplinkEndpoints(const Participant& participant) {
  auto session = Writer<SessionAnnouncement>::Open(participant);
  if (!session) return tl::make_unexpected(session.error());
  auto edits = Writer<Envelope>::Open(participant);
  if (!edits) return tl::make_unexpected(edits.error());
  auto interest = Writer<MapInterest>::Open(participant);
  if (!interest) return tl::make_unexpected(interest.error());
  auto where = Writer<RelocalizationRequest>::Open(participant);
  if (!where) return tl::make_unexpected(where.error());
  auto state = Writer<AgentState>::Open(participant);
  if (!state) return tl::make_unexpected(state.error());
  auto acks = Reader<EditAck>::Open(participant);
  if (!acks) return tl::make_unexpected(acks.error());
  auto corrections = Reader<CorrectionPart>::Open(participant);
  if (!corrections) return tl::make_unexpected(corrections.error());
  auto answers = Reader<RelocalizationAnswer>::Open(participant);
  if (!answers) return tl::make_unexpected(answers.error());
  return UplinkEndpoints{std::move(*session), std::move(*edits), std::move(*interest),    std::move(*where),
                         std::move(*state),   std::move(*acks),  std::move(*corrections), std::move(*answers)};
}

}  // namespace pangaea
