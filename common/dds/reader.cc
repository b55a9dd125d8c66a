#include "common/dds/reader.h"

#include <dds/dds.h>

#include <array>
#include <memory>
#include <string>

#include "common/dds/dds_status.h"
#include "common/dds/endpoint_qos.h"

namespace pangaea {
namespace {

constexpr std::size_t kBatch = 32;

}  // namespace

Result<ReaderBase> ReaderBase::Open(const Participant& participant, const TopicDescription& topic) {
  ReaderBase reader;
  auto topic_entity = DdsEntityOf(CreateTopic(participant, topic), std::string("topic ") + topic.name);
  if (!topic_entity) return tl::make_unexpected(topic_entity.error());
  reader.topic_ = std::move(*topic_entity);
  const QosPointer qos = EndpointQos(topic, std::chrono::nanoseconds::zero());
  auto entity = DdsEntityOf(dds_create_reader(participant.subscriber(), reader.topic_.get(), qos.get(), nullptr),
                            std::string("reader of ") + topic.name);
  if (!entity) return tl::make_unexpected(entity.error());
  reader.reader_ = std::move(*entity);
  return reader;
}

void ReaderBase::TakeRaw(const std::function<void(const RawSample&)>& visit) {
  for (;;) {
    std::array<void*, kBatch> samples{};
    std::array<dds_sample_info_t, kBatch> infos;
    const dds_return_t count = dds_take(entity(), samples.data(), infos.data(), kBatch, kBatch);
    if (count <= 0) return;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const dds_sample_info_t& info = infos[i];
      visit({samples[i], info.valid_data, info.instance_state == DDS_IST_ALIVE, info.publication_handle,
             info.source_timestamp});
    }
    dds_return_loan(entity(), samples.data(), count);
  }
}

std::vector<PublicationHandle> ReaderBase::MatchedPublications() const {
  std::vector<PublicationHandle> handles;
  // The number may grow between asking for it and asking for the handles.
  for (dds_return_t count = dds_get_matched_publications(entity(), nullptr, 0);
       count > static_cast<dds_return_t>(handles.size());) {
    handles.resize(static_cast<std::size_t>(count));
    count = dds_get_matched_publications(entity(), handles.data(), handles.size());
    if (count >= 0 && count < static_cast<dds_return_t>(handles.size()))
      handles.resize(static_cast<std::size_t>(count));
  }
  return handles;
}

std::uint64_t ReaderBase::ParticipantOf(PublicationHandle publication) const {
  dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(entity(), publication);
  if (endpoint == nullptr) return 0;
  const std::uint64_t participant = endpoint->participant_instance_handle;
  dds_builtintopic_free_endpoint(endpoint);
  return participant;
}

}  // namespace pangaea
