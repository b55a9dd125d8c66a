#pragma once
// The generated C structs of the topics and back. For common/dds and tests alone: nobody else sees IDL types.

#include <vector>

#include "common/base/result.h"
#include "common/wire/agent_state.h"
#include "common/wire/atlas_event.h"
#include "common/wire/atlas_status.h"
#include "common/wire/edit_ack.h"
#include "common/wire/envelope.h"
#include "common/wire/session_announcement.h"
#include "idl/agent_state.h"
#include "idl/atlas_events.h"
#include "idl/atlas_status.h"
#include "idl/edit_acks.h"
#include "idl/map_edits.h"
#include "idl/session.h"

namespace pangaea {

// Texts longer than this are refused when read; the status has a limit of its own.
inline constexpr std::size_t kMaxWireText = 4096;
inline constexpr std::size_t kMaxStatusBytes = 4U << 20U;
inline constexpr std::size_t kMaxRejections = 1024;

// The C structs borrow the octets and texts of the value: they are valid as long as it is, and are never freed.
pangaea_wire_SessionInfo BorrowAsIdl(const SessionAnnouncement& value);
pangaea_wire_MapEdits BorrowAsIdl(const Envelope& value);
// `rejections` holds the list for as long as the result is used.
pangaea_wire_EditAck BorrowAsIdl(const EditAck& value, std::vector<pangaea_wire_Rejection>& rejections);
pangaea_wire_AgentState BorrowAsIdl(const AgentState& value);
pangaea_wire_AtlasStatus BorrowAsIdl(const AtlasStatus& value);
pangaea_wire_AtlasEvent BorrowAsIdl(const AtlasEvent& value);

// kInvalidArgument for numbers no peer of ours would send. Null texts (of older peers) read as empty. An envelope's
// contents are not judged here: CheckEnvelope does.
Result<SessionAnnouncement> FromIdl(const pangaea_wire_SessionInfo& sample);
Result<Envelope> FromIdl(const pangaea_wire_MapEdits& sample);
Result<EditAck> FromIdl(const pangaea_wire_EditAck& sample);
Result<AgentState> FromIdl(const pangaea_wire_AgentState& sample);
Result<AtlasStatus> FromIdl(const pangaea_wire_AtlasStatus& sample);
Result<AtlasEvent> FromIdl(const pangaea_wire_AtlasEvent& sample);

}  // namespace pangaea
