#pragma once

#include <dds/dds.h>

#include <chrono>
#include <memory>

#include "common/dds/topics.h"

namespace pangaea {

using QosPointer = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

// Reliability, durability and history of a topic, the same for its readers and writers.
inline QosPointer EndpointQos(const TopicDescription& topic, std::chrono::nanoseconds max_blocking_time) {
  QosPointer qos(dds_create_qos(), dds_delete_qos);
  dds_qset_reliability(qos.get(), topic.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       max_blocking_time.count());
  dds_qset_durability(qos.get(), topic.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  const bool keeps_all = topic.history_depth == 0;
  dds_qset_history(qos.get(), keeps_all ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST,
                   keeps_all ? 1 : topic.history_depth);
  if (topic.transient_local) {
    // How much late joiners get is decided by this setting, not by the history above.
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, topic.history_depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  return qos;
}

inline dds_entity_t CreateTopic(const Participant& participant, const TopicDescription& topic) {
  return dds_create_topic(participant.participant(), static_cast<const dds_topic_descriptor_t*>(topic.type), topic.name,
                          nullptr, nullptr);
}

}  // namespace pangaea
