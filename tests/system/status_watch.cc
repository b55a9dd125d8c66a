#include "tests/system/status_watch.h"

#include <gtest/gtest.h>

#include <algorithm>

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
    const auto& sessions = json.at("sessions");
    for (const auto& session : sessions) acknowledged += session.at("acknowledged").get<std::uint64_t>();
    const bool is_over = !sessions.empty() && std::ranges::all_of(sessions, [](const auto& session) {
      return session.at("closed").template get<bool>();
    });
    if (acknowledged >= count || is_over) return acknowledged;
  }
}

}  // namespace pangaea
