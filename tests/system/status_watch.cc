#include "tests/system/status_watch.h"

#include <gtest/gtest.h>

namespace pangaea {

StatusWatch::StatusWatch(const std::string& site)
    : domain_(Domain::Open({}).value()),
      participant_(Participant::Open(domain_, site).value()),
      reader_(Reader<AtlasStatus>::Open(participant_).value()),
      waiter_(Waiter::Create(participant_).value()) {
  EXPECT_TRUE(waiter_->OnSample<AtlasStatus>(reader_, [this](Sample<AtlasStatus> sample) {
    if (sample.alive) statuses_.PushNewest(std::move(sample.value));
  }));
  waiter_->Start();
}

std::uint64_t StatusWatch::WaitForAcknowledged(std::uint64_t incarnation, std::uint64_t count) {
  for (;;) {
    const AtlasStatus status = *statuses_.Pop();
    if (status.server_incarnation != incarnation) continue;
    std::uint64_t acknowledged = 0;
    const auto json = nlohmann::json::parse(status.json);
    for (const auto& session : json.at("sessions")) acknowledged += session.at("acknowledged").get<std::uint64_t>();
    if (acknowledged >= count) return acknowledged;
  }
}

}  // namespace pangaea
