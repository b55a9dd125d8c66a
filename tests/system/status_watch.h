#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "common/base/bounded_queue.h"
#include "common/dds/participant.h"
#include "common/dds/reader.h"
#include "common/dds/waiter.h"

namespace pangaea {

// Reads the status that the servers of a site publish.
class StatusWatch {
 public:
  explicit StatusWatch(const std::string& site);
  ~StatusWatch() { waiter_->Stop(); }
  StatusWatch(const StatusWatch&) = delete;
  StatusWatch& operator=(const StatusWatch&) = delete;

  // Waits until the sessions of the server's `incarnation` have so many acknowledged envelopes together,
  // or their agents have ended. Their number.
  std::uint64_t WaitForAcknowledged(std::uint64_t incarnation, std::uint64_t count);

 private:
  Domain domain_;
  Participant participant_;
  Reader<AtlasStatus> reader_;
  BoundedQueue<AtlasStatus> statuses_{1000};
  std::unique_ptr<Waiter> waiter_;
};

}  // namespace pangaea
