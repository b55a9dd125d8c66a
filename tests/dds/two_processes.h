#pragma once

#include <unistd.h>

#include <string>

#include "common/dds/participant.h"

namespace pangaea {

// One of two domains of a test program that meet only over the network, as two processes would. The tag keeps test
// programs that run at the same time apart.
inline DomainOptions TestDomain(std::uint32_t id) {
  DomainOptions options;
  options.id = id;
  options.external_id = 0;
  options.configuration = kLoopbackConfiguration;
  options.discovery_tag = "test-" + std::to_string(getpid());
  return options;
}

// A domain and one participant of it.
struct TestNode {
  explicit TestNode(std::uint32_t id, const std::string& site = "hall")
      : domain(Domain::Open(TestDomain(id)).value()), participant(Participant::Open(domain, site).value()) {}

  Domain domain;
  Participant participant;
};

}  // namespace pangaea
