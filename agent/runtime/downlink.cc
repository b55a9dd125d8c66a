#include "agent/runtime/downlink.h"

#include <algorithm>
#include <utility>

namespace pangaea {

Status Downlink::Receive(CorrectionPart part, const EditStream& stream) {
  auto correction = assembly_.Take(std::move(part));
  if (!correction) return tl::make_unexpected(correction.error());
  if (!correction->has_value() || stream.IsTooOld(**correction)) return {};
  waiting_.push_back(std::make_shared<const AgentCorrection>(std::move(**correction)));
  return {};
}

void Downlink::OnAck(const EditAck& ack) {
  MutexLock lock(mutex_);
  newest_version_ = std::max(newest_version_, ack.correction_version);
  server_works_ = ack.working;
  changed_.notify_all();
}

void Downlink::OnServerLost() {
  MutexLock lock(mutex_);
  newest_version_ = absorbed_version_;
  server_works_ = false;
  changed_.notify_all();
}

void Downlink::Offer(EditStream& stream) {
  if (offered_) return;
  while (!waiting_.empty() && stream.IsTooOld(*waiting_.front())) waiting_.pop_front();
  if (waiting_.empty()) return;
  auto base = stream.BaseOf(*waiting_.front());
  if (!base) return;
  offered_ = true;
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
  while (!ready_ && !hurried_ && (server_works_ || newest_version_ > absorbed_version_)) {
    if (std::chrono::steady_clock::now() >= deadline) return false;
    changed_.wait_until(mutex_, deadline);
  }
  return ready_.has_value();
}

void Downlink::EndWaiting() {
  MutexLock lock(mutex_);
  hurried_ = true;
  changed_.notify_all();
}

}  // namespace pangaea
