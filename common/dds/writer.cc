#include "common/dds/writer.h"

#include <dds/dds.h>

#include <string>

#include "common/dds/dds_status.h"
#include "common/dds/endpoint_qos.h"

namespace pangaea {

Result<WriterBase> WriterBase::Open(const Participant& participant, const TopicDescription& topic,
                                    const WriterOptions& options) {
  WriterBase writer;
  auto topic_entity = DdsEntityOf(CreateTopic(participant, topic), std::string("topic ") + topic.name);
  if (!topic_entity) return tl::make_unexpected(topic_entity.error());
  writer.topic_ = std::move(*topic_entity);
  const QosPointer qos = EndpointQos(topic, options.max_blocking_time);
  auto entity = DdsEntityOf(dds_create_writer(participant.publisher(), writer.topic_.get(), qos.get(), nullptr),
                            std::string("writer of ") + topic.name);
  if (!entity) return tl::make_unexpected(entity.error());
  writer.writer_ = std::move(*entity);
  return writer;
}

Status WriterBase::WriteStatus(std::int32_t code, const char* topic) {
  if (code >= 0) return {};
  return DdsStatus(code, std::string("writing to ") + topic);
}

Status WriterBase::WaitForAcks(std::chrono::nanoseconds timeout) const {
  return DdsStatus(dds_wait_for_acks(entity(), timeout.count()), "waiting for acknowledgement");
}

std::uint32_t WriterBase::matched() const {
  // Not by the matched status, whose change counters a Waiter reports and reading resets.
  const dds_return_t count = dds_get_matched_subscriptions(entity(), nullptr, 0);
  return count < 0 ? 0 : static_cast<std::uint32_t>(count);
}

}  // namespace pangaea
