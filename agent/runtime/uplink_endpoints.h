#pragma once

#include "common/base/result.h"
#include "common/dds/participant.h"
#include "common/dds/reader.h"
#include "common/dds/writer.h"

namespace pangaea {

// An agent's readers and writers, all of which the uplink's thread owns.
struct UplinkEndpoints {
  Writer<SessionAnnouncement> session;
  Writer<Envelope> edits;
  Writer<MapInterest> interest;
  Writer<RelocalizationRequest> where;
  Writer<AgentState> state;
  Reader<EditAck> acks;
  Reader<CorrectionPart> corrections;
  Reader<RelocalizationAnswer> answers;
};

// Errors: kUnavailable where DDS refuses one of them.
Result<UplinkEndpoints> OpenUplinkEndpoints(const Participant& participant);

}  // namespace pangaea
