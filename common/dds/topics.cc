#include "common/dds/topics.h"

#include <dds/dds.h>

#include <vector>

#include "common/wire/idl_conversions.h"

namespace pangaea {
namespace {

constexpr int kKeepAll = 0;

template <typename Value>
struct Idl;
template <>
struct Idl<SessionAnnouncement> {
  using Sample = pangaea_wire_SessionInfo;
  static constexpr TopicDescription kTopic{"pangaea_session", &pangaea_wire_SessionInfo_desc, true, true, 1};
  static SessionAnnouncement Key(const Sample& sample) {
    SessionAnnouncement session;
    session.session = sample.session;
    return session;
  }
};
template <>
struct Idl<Envelope> {
  using Sample = pangaea_wire_MapEdits;
  static constexpr TopicDescription kTopic{"pangaea_map_edits", &pangaea_wire_MapEdits_desc, true, false, kKeepAll};
  static Envelope Key(const Sample& sample) {
    Envelope envelope;
    envelope.session = sample.session;
    return envelope;
  }
};
template <>
struct Idl<EditAck> {
  using Sample = pangaea_wire_EditAck;
  static constexpr TopicDescription kTopic{"pangaea_edit_acks", &pangaea_wire_EditAck_desc, true, false, kKeepAll};
  static EditAck Key(const Sample& sample) { return {.session = sample.session, .rejections = {}}; }
};
template <>
struct Idl<AgentState> {
  using Sample = pangaea_wire_AgentState;
  static constexpr TopicDescription kTopic{"pangaea_agent_state", &pangaea_wire_AgentState_desc, false, false, 1};
  static AgentState Key(const Sample& sample) {
    AgentState state;
    state.session = sample.session;
    return state;
  }
};
template <>
struct Idl<AtlasStatus> {
  using Sample = pangaea_wire_AtlasStatus;
  static constexpr TopicDescription kTopic{"pangaea_atlas_status", &pangaea_wire_AtlasStatus_desc, true, true, 1};
  static AtlasStatus Key(const Sample& sample) {
    return {.site = sample.site == nullptr ? "" : sample.site, .json = {}};
  }
};
template <>
struct Idl<AtlasEvent> {
  using Sample = pangaea_wire_AtlasEvent;
  static constexpr TopicDescription kTopic{"pangaea_atlas_events", &pangaea_wire_AtlasEvent_desc, true, true, 100};
  static AtlasEvent Key(const Sample& sample) {
    return {.site = sample.site == nullptr ? "" : sample.site, .text = {}};
  }
};
template <>
struct Idl<CorrectionPart> {
  using Sample = pangaea_wire_CorrectionPart;
  static constexpr TopicDescription kTopic{"pangaea_corrections", &pangaea_wire_CorrectionPart_desc, true, false,
                                           kKeepAll};
  static CorrectionPart Key(const Sample& sample) {
    CorrectionPart value;
    value.session = sample.session;
    return value;
  }
};
template <>
struct Idl<MapInterest> {
  using Sample = pangaea_wire_MapInterest;
  static constexpr TopicDescription kTopic{"pangaea_map_interest", &pangaea_wire_MapInterest_desc, true, true, 1};
  static MapInterest Key(const Sample& sample) {
    MapInterest value;
    value.session = sample.session;
    return value;
  }
};
template <>
struct Idl<RelocalizationRequest> {
  using Sample = pangaea_wire_RelocalizationRequest;
  static constexpr TopicDescription kTopic{"pangaea_relocalization_requests", &pangaea_wire_RelocalizationRequest_desc,
                                           true, false, kKeepAll};
  static RelocalizationRequest Key(const Sample& sample) {
    RelocalizationRequest value;
    value.session = sample.session;
    return value;
  }
};
template <>
struct Idl<RelocalizationAnswer> {
  using Sample = pangaea_wire_RelocalizationAnswer;
  static constexpr TopicDescription kTopic{"pangaea_relocalization_answers", &pangaea_wire_RelocalizationAnswer_desc,
                                           true, false, kKeepAll};
  static RelocalizationAnswer Key(const Sample& sample) {
    RelocalizationAnswer value;
    value.session = sample.session;
    return value;
  }
};
template <>
struct Idl<UndoRequest> {
  using Sample = pangaea_wire_UndoRequest;
  static constexpr TopicDescription kTopic{"pangaea_undo_requests", &pangaea_wire_UndoRequest_desc, true, false,
                                           kKeepAll};
  static UndoRequest Key(const Sample& sample) { return {sample.request, {}}; }
};
template <>
struct Idl<UndoAnswer> {
  using Sample = pangaea_wire_UndoAnswer;
  static constexpr TopicDescription kTopic{"pangaea_undo_answers", &pangaea_wire_UndoAnswer_desc, true, false,
                                           kKeepAll};
  static UndoAnswer Key(const Sample& sample) { return {sample.request, false, {}}; }
};

}  // namespace

template <typename Value>
const TopicDescription& TopicTraits<Value>::Describe() {
  return Idl<Value>::kTopic;
}

template <typename Value>
std::int32_t TopicTraits<Value>::Write(std::int32_t writer, const Value& value) {
  if constexpr (std::is_same_v<Value, EditAck>) {
    std::vector<pangaea_wire_Rejection> rejections;
    const auto sample = BorrowAsIdl(value, rejections);
    return dds_write(writer, &sample);
  } else if constexpr (std::is_same_v<Value, MapInterest>) {
    std::vector<pangaea_wire_ItemId> ids;
    const auto sample = BorrowAsIdl(value, ids);
    return dds_write(writer, &sample);
  } else if constexpr (std::is_same_v<Value, RelocalizationRequest>) {
    std::vector<std::byte> octets;
    const auto sample = BorrowAsIdl(value, octets);
    return dds_write(writer, &sample);
  } else {
    const auto sample = BorrowAsIdl(value);
    return dds_write(writer, &sample);
  }
}

template <typename Value>
Result<Value> TopicTraits<Value>::FromSample(const void* sample) {
  return FromIdl(*static_cast<const typename Idl<Value>::Sample*>(sample));
}

template <typename Value>
Value TopicTraits<Value>::KeyFromSample(const void* sample) {
  return Idl<Value>::Key(*static_cast<const typename Idl<Value>::Sample*>(sample));
}

template struct TopicTraits<SessionAnnouncement>;
template struct TopicTraits<Envelope>;
template struct TopicTraits<EditAck>;
template struct TopicTraits<AgentState>;
template struct TopicTraits<AtlasStatus>;
template struct TopicTraits<AtlasEvent>;
template struct TopicTraits<CorrectionPart>;
template struct TopicTraits<MapInterest>;
template struct TopicTraits<RelocalizationRequest>;
template struct TopicTraits<RelocalizationAnswer>;
template struct TopicTraits<UndoRequest>;
template struct TopicTraits<UndoAnswer>;

}  // namespace pangaea
