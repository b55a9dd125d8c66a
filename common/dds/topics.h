#pragma once

#include <cstdint>

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

namespace pangaea {

struct TopicDescription {
  const char* name;
  const void* type;  // the generated dds_topic_descriptor_t
  bool reliable;
  bool transient_local;  // readers that come later get the last `history_depth` of each key
  int history_depth;     // 0 keeps all
};

// What the typed readers and writers need to know about a value's topic. `sample` is the generated C struct.
template <typename Value>
struct TopicTraits {
  static const TopicDescription& Describe();
  // Hands the C form of `value` to dds_write; the library's return code.
  static std::int32_t Write(std::int32_t writer, const Value& value);
  // Fails for numbers no peer of ours would send: not finite, or out of every range.
  static Result<Value> FromSample(const void* sample);
  // Of a sample that only tells the fate of its instance: the key, the rest as default.
  static Value KeyFromSample(const void* sample);
};

extern template struct TopicTraits<SessionAnnouncement>;
extern template struct TopicTraits<Envelope>;
extern template struct TopicTraits<EditAck>;
extern template struct TopicTraits<AgentState>;
extern template struct TopicTraits<AtlasStatus>;
extern template struct TopicTraits<AtlasEvent>;
extern template struct TopicTraits<CorrectionPart>;
extern template struct TopicTraits<MapInterest>;
extern template struct TopicTraits<RelocalizationRequest>;
extern template struct TopicTraits<RelocalizationAnswer>;
extern template struct TopicTraits<UndoRequest>;
extern template struct TopicTraits<UndoAnswer>;

}  // namespace pangaea
