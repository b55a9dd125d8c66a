#pragma once
// The generated C structs of the topics and back. For common/dds and tests alone: nobody else sees IDL types.

#include <vector>

#include "common/base/result.h"
#include "common/wire/agent_correction.h"
#include "common/wire/agent_state.h"
#include "common/wire/atlas_event.h"
#include "common/wire/atlas_status.h"
#include "common/wire/edit_ack.h"
#include "common/wire/envelope.h"
#include "common/wire/map_interest.h"
#include "common/wire/relocalization.h"
#include "common/wire/session_announcement.h"
#include "common/wire/undo.h"
#include "idl/agent_state.h"
#include "idl/atlas_events.h"
#include "idl/atlas_status.h"
#include "idl/corrections.h"
#include "idl/edit_acks.h"
#include "idl/map_edits.h"
#include "idl/map_interest.h"
#include "idl/relocalization.h"
#include "idl/session.h"
#include "idl/undo.h"

namespace pangaea {

// Texts longer than this are refused when read; the status has a limit of its own.
inline constexpr std::size_t kMaxWireText = 4096;
inline constexpr std::size_t kMaxStatusBytes = 4U << 20U;
inline constexpr std::size_t kMaxRejections = 1024;
inline constexpr std::size_t kMaxInterestIds = 100'000;
inline constexpr std::size_t kMaxFrameBytes = 1U << 20U;

// The C structs borrow the octets and texts of the value: they are valid as long as it is, and are never freed.
pangaea_wire_SessionInfo BorrowAsIdl(const SessionAnnouncement& value);
pangaea_wire_MapEdits BorrowAsIdl(const Envelope& value);
// `rejections` holds the list for as long as the result is used.
pangaea_wire_EditAck BorrowAsIdl(const EditAck& value, std::vector<pangaea_wire_Rejection>& rejections);
pangaea_wire_AgentState BorrowAsIdl(const AgentState& value);
pangaea_wire_AtlasStatus BorrowAsIdl(const AtlasStatus& value);
pangaea_wire_AtlasEvent BorrowAsIdl(const AtlasEvent& value);
pangaea_wire_CorrectionPart BorrowAsIdl(const CorrectionPart& value);
// `ids` and `octets` hold what the result borrows.
pangaea_wire_MapInterest BorrowAsIdl(const MapInterest& value, std::vector<pangaea_wire_ItemId>& ids);
pangaea_wire_RelocalizationRequest BorrowAsIdl(const RelocalizationRequest& value, std::vector<std::byte>& octets);
pangaea_wire_RelocalizationAnswer BorrowAsIdl(const RelocalizationAnswer& value);
pangaea_wire_UndoRequest BorrowAsIdl(const UndoRequest& value);
pangaea_wire_UndoAnswer BorrowAsIdl(const UndoAnswer& value);

// kInvalidArgument for numbers no peer of ours would send. Null texts (of older peers) read as empty. An envelope's
// contents are not judged here: CheckEnvelope does.
Result<SessionAnnouncement> FromIdl(const pangaea_wire_SessionInfo& sample);
Result<Envelope> FromIdl(const pangaea_wire_MapEdits& sample);
Result<EditAck> FromIdl(const pangaea_wire_EditAck& sample);
Result<AgentState> FromIdl(const pangaea_wire_AgentState& sample);
Result<AtlasStatus> FromIdl(const pangaea_wire_AtlasStatus& sample);
Result<AtlasEvent> FromIdl(const pangaea_wire_AtlasEvent& sample);
Result<CorrectionPart> FromIdl(const pangaea_wire_CorrectionPart& sample);
Result<MapInterest> FromIdl(const pangaea_wire_MapInterest& sample);
Result<RelocalizationRequest> FromIdl(const pangaea_wire_RelocalizationRequest& sample);
Result<RelocalizationAnswer> FromIdl(const pangaea_wire_RelocalizationAnswer& sample);
Result<UndoRequest> FromIdl(const pangaea_wire_UndoRequest& sample);
Result<UndoAnswer> FromIdl(const pangaea_wire_UndoAnswer& sample);
// Shared by the files that convert.
pangaea_wire_RigidPose ToIdl(const Rigid3d& pose);
Result<Rigid3d> ReadPose(const pangaea_wire_RigidPose& sample, const char* what);

}  // namespace pangaea
