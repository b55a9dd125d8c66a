#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "common/dds/entity.h"

namespace pangaea {

struct DomainOptions {
  std::uint32_t id = 0;  // 0 to 230
  // XML, or a comma-separated list of XML and file:// names. Empty: the environment's CYCLONEDDS_URI; without that
  // kLoopbackConfiguration.
  std::string configuration;
  // Only participants with the same tag see each other: keeps runs on one machine apart. Empty: the environment's
  // PANGAEA_DDS_TAG. Letters, digits, '.', '_', '-'.
  std::string discovery_tag;
  // The id others see, where one process opens the same domain twice under different ids.
  std::optional<std::uint32_t> external_id;

  Status Check() const;
};

// The configuration without multicast, on loopback alone, that is used when the user gives none. The same text as
// config/cyclonedds-loopback.xml.
extern const std::string_view kLoopbackConfiguration;

// The DDS library's threads and sockets for one domain. At most one of an id in a process. Outlives everything opened
// in it. Opening fails with kInvalidArgument (options), kUnavailable (configuration refused, or no free port).
class Domain {
 public:
  static Result<Domain> Open(const DomainOptions& options);

  std::uint32_t id() const { return id_; }
  // Cuts the domain off from all others, or joins it again: for tests of broken links.
  void SetLinkDown(bool down);

 private:
  Domain(std::uint32_t id, DdsEntity entity) : id_(id), entity_(std::move(entity)) {}

  std::uint32_t id_;
  DdsEntity entity_;
};

// Takes part in one site (a DDS partition) of a domain. Any thread may use it; it outlives its readers and writers.
class Participant {
 public:
  // `site`: 1 to 64 of letters, digits, '.', '_', '-' (kInvalidArgument).
  static Result<Participant> Open(const Domain& domain, const std::string& site);

  const std::string& site() const { return site_; }
  std::int32_t participant() const { return participant_.get(); }
  std::int32_t publisher() const { return publisher_.get(); }
  std::int32_t subscriber() const { return subscriber_.get(); }

 private:
  Participant() = default;

  std::string site_;
  DdsEntity participant_;
  DdsEntity publisher_;
  DdsEntity subscriber_;
};

// Whether `site` may name a site.
Status CheckSiteName(const std::string& site);

}  // namespace pangaea
