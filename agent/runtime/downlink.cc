#include "agent/runtime/downlink.h"

#include <algorithm>
#include <utility>

namespace pangaea {

Status Downlink::Receive(CorrectionPart part, const EditStream& stream) {
  auto correction = assembly_.Take(std::move(part));
  if (!correction) return tl::make_unexpected(correction.error());
  if (!correction->has_value() || stream.IsTooOld(**correction)) return {};
  waiting_.push_back(std::make_shared<AgentCorrection>(std::move(**correction)));
  return {};
}

void Downlink::OnAck(const EditAck& ack) {
  MutexLock lock(mutex_);
  newest_version_ = std::max(newest_version_, ack.correction_version);
  server_works_ = ack.working;
  agreed_claim_ = std::max(agreed_claim_, ack.agreed_claim);
  changed_.notify_all();
}

void Downlink::OnServerLost() {
  MutexLock lock(mutex_);
  newest_version_ = absorbed_version_;
  server_works_ = false;
  agreed_claim_ = claimed_;
  changed_.notify_all();
}

void Downlink::OnClaim(std::uint64_t number) {
  MutexLock lock(mutex_);
  claimed_ = number;
}

void Downlink::Offer(EditStream& stream) {
  if (offered_) return;
  while (!waiting_.empty() && stream.IsTooOld(*waiting_.front())) waiting_.pop_front();
  if (waiting_.empty()) return;
  auto base = stream.BaseOf(*waiting_.front());
  if (!base) return;
  offered_ = true;
  // What was sent since, it does not know.
  waiting_.front()->complete &= waiting_.front()->acknowledged == stream.retained().last_sequence();
  MutexLock lock(mutex_);
  ready_ = ReadyCorrection{std::move(waiting_.front()), std::move(*base)};
  waiting_.pop_front();
  changed_.notify_all();
}

void Downlink::OnAbsorbed(std::uint64_t version) {
  offered_ = false;
  MutexLock lock(mutex_);
  absorbed_version_ = version;
  changed_.notify_all();
}

std::optional<ReadyCorrection> Downlink::Take() {
  MutexLock lock(mutex_);
  return std::exchange(ready_, std::nullopt);
}

bool Downlink::Await(Time deadline) {
  MutexLock lock(mutex_);
  const auto is_settled = [this]() REQUIRES(mutex_) {
    return !server_works_ && newest_version_ <= absorbed_version_ && agreed_claim_ >= claimed_;
  };
  while (!ready_ && !hurried_ && !is_settled()) {
    if (std::chrono::steady_clock::now() >= deadline) return false;
    changed_.wait_until(mutex_, deadline);
  }
  return ready_.has_value();
}

bool Downlink::agrees() {
  MutexLock lock(mutex_);
  return agreed_claim_ >= claimed_;
}

void Downlink::EndWaiting() {
  MutexLock lock(mutex_);
  hurried_ = true;
  changed_.notify_all();
}

}  // namespace pangaea
