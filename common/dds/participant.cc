#include "common/dds/participant.h"

#include <dds/dds.h>

#include <cstdlib>
#include <memory>

#include "common/dds/dds_status.h"

namespace pangaea {

// Measured: the default fragment size halves the throughput; WhcHigh is twice what an uplink has in flight; a reader
// that was killed stalls its writers until the lease ends.
const std::string_view kLoopbackConfiguration =
    R"(<CycloneDDS xmlns="https://cdds.io/config"><Domain Id="any">
 <General>
  <Interfaces><NetworkInterface address="127.0.0.1" multicast="false"/></Interfaces>
  <AllowMulticast>false</AllowMulticast>
  <MaxMessageSize>65500B</MaxMessageSize><FragmentSize>60000B</FragmentSize>
 </General>
 <Discovery>
  <ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>40</MaxAutoParticipantIndex>
  <Peers><Peer Address="127.0.0.1"/></Peers><LeaseDuration>3s</LeaseDuration>
 </Discovery>
 <Internal>
  <SocketReceiveBufferSize min="default" max="4MB"/><Watermarks><WhcHigh>8MB</WhcHigh></Watermarks>
 </Internal>
</Domain></CycloneDDS>
)";

namespace {

constexpr std::uint32_t kLargestDomainId = 230;  // beyond it ports would exceed 65535
constexpr std::size_t kLongestName = 64;

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

bool IsName(const std::string& text) {
  return !text.empty() && text.size() <= kLongestName &&
         text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-") ==
             std::string::npos;
}

std::string Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

// The library joins fragments that are separated by commas.
std::string Configuration(const DomainOptions& options, const std::string& tag) {
  std::string text = options.configuration;
  if (text.empty()) text = Environment("CYCLONEDDS_URI");
  if (text.empty()) text = kLoopbackConfiguration;
  std::string discovery;
  if (!tag.empty()) discovery += "<Tag>" + tag + "</Tag>";
  if (options.external_id) {
    discovery += "<ExternalDomainId>" + std::to_string(*options.external_id) + "</ExternalDomainId>";
  }
  if (discovery.empty()) return text;
  return text + ",<CycloneDDS><Domain Id=\"any\"><Discovery>" + discovery + "</Discovery></Domain></CycloneDDS>";
}

}  // namespace

Status CheckSiteName(const std::string& site) {
  if (IsName(site)) return {};
  return Fail(ErrorCode::kInvalidArgument, "site '" + site + "': 1 to 64 letters, digits, '.', '_' or '-' are allowed");
}

Status DomainOptions::Check() const {
  if (id > kLargestDomainId || external_id.value_or(0) > kLargestDomainId) {
    return Fail(ErrorCode::kInvalidArgument, "DDS domain id: 0 to " + std::to_string(kLargestDomainId));
  }
  if (!discovery_tag.empty() && !IsName(discovery_tag)) {
    return Fail(ErrorCode::kInvalidArgument,
                "DDS discovery tag '" + discovery_tag + "': 1 to 64 letters, digits, '.', '_' or '-' are allowed");
  }
  return {};
}

Result<Domain> Domain::Open(const DomainOptions& options) {
  DomainOptions checked = options;
  if (checked.discovery_tag.empty()) checked.discovery_tag = Environment("PANGAEA_DDS_TAG");
  if (const Status status = checked.Check(); !status) return tl::make_unexpected(status.error());
  const std::string configuration = Configuration(checked, checked.discovery_tag);
  auto entity = DdsEntityOf(dds_create_domain(options.id, configuration.c_str()),
                            "opening domain " + std::to_string(options.id) + " (its configuration, or a second time)");
  if (!entity) return tl::make_unexpected(entity.error());
  return Domain(options.id, std::move(*entity));
}

void Domain::SetLinkDown(bool down) { dds_domain_set_deafmute(entity_.get(), down, down, DDS_INFINITY); }

Result<Participant> Participant::Open(const Domain& domain, const std::string& site) {
  if (const Status status = CheckSiteName(site); !status) return tl::make_unexpected(status.error());
  Participant participant;
  participant.site_ = site;
  auto entity = DdsEntityOf(dds_create_participant(domain.id(), nullptr, nullptr), "joining the domain");
  if (!entity) return tl::make_unexpected(entity.error());
  participant.participant_ = std::move(*entity);

  const Qos qos(dds_create_qos(), dds_delete_qos);
  const char* partition = site.c_str();
  dds_qset_partition(qos.get(), 1, &partition);
  auto publisher =
      DdsEntityOf(dds_create_publisher(participant.participant(), qos.get(), nullptr), "creating a publisher");
  if (!publisher) return tl::make_unexpected(publisher.error());
  participant.publisher_ = std::move(*publisher);
  auto subscriber =
      DdsEntityOf(dds_create_subscriber(participant.participant(), qos.get(), nullptr), "creating a subscriber");
  if (!subscriber) return tl::make_unexpected(subscriber.error());
  participant.subscriber_ = std::move(*subscriber);
  return participant;
}

}  // namespace pangaea
