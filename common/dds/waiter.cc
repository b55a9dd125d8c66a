#include "common/dds/waiter.h"

#include <dds/dds.h>

#include <algorithm>
#include <array>

#include "common/base/check.h"
#include "common/dds/dds_status.h"

namespace pangaea {
namespace {

constexpr std::size_t kMostTriggers = 16;

}  // namespace

Result<std::unique_ptr<Waiter>> Waiter::Create(const Participant& participant) {
  std::unique_ptr<Waiter> waiter(new Waiter);
  auto waitset = DdsEntityOf(dds_create_waitset(participant.participant()), "creating a waitset");
  if (!waitset) return tl::make_unexpected(waitset.error());
  waiter->waitset_ = std::move(*waitset);
  auto stop = DdsEntityOf(dds_create_guardcondition(participant.participant()), "creating a guard condition");
  if (!stop) return tl::make_unexpected(stop.error());
  waiter->stop_condition_ = std::move(*stop);
  const Status status = waiter->Watch(waiter->stop_condition_.get(), {});
  if (!status) return tl::make_unexpected(status.error());
  return waiter;
}

Waiter::~Waiter() {
  Stop();
  for (const Handler& handler : handlers_) dds_waitset_detach(waitset_.get(), handler.condition);
}

// The index of the handler is what the waitset reports.
Status Waiter::Watch(std::int32_t condition, std::function<void()> run) {
  PANGAEA_CHECK(!thread_.joinable());
  const auto index = static_cast<dds_attach_t>(handlers_.size());
  Status status = DdsStatus(dds_waitset_attach(waitset_.get(), condition, index), "attaching to a waitset");
  if (status) handlers_.push_back({condition, std::move(run)});
  return status;
}

Status Waiter::OnData(std::int32_t reader, std::function<void()> run) {
  auto condition = DdsEntityOf(dds_create_readcondition(reader, DDS_ANY_STATE), "creating a read condition");
  if (!condition) return tl::make_unexpected(condition.error());
  read_conditions_.push_back(std::move(*condition));
  return Watch(read_conditions_.back().get(), std::move(run));
}

Status Waiter::OnStatus(std::int32_t entity, std::uint32_t status, std::function<void()> run) {
  const Status masked = DdsStatus(dds_set_status_mask(entity, status), "setting a status mask");
  if (!masked) return masked;
  return Watch(entity, std::move(run));
}

Status Waiter::OnMatch(const ReaderBase& reader, std::function<void(const MatchChange&)> callback) {
  const std::int32_t entity = reader.entity();
  return OnStatus(entity, DDS_SUBSCRIPTION_MATCHED_STATUS, [entity, callback = std::move(callback)] {
    dds_subscription_matched_status_t status{};
    if (dds_get_subscription_matched_status(entity, &status) < 0) return;
    callback({status.current_count, status.current_count_change, status.last_publication_handle});
  });
}

Status Waiter::OnMatch(const WriterBase& writer, std::function<void(const MatchChange&)> callback) {
  const std::int32_t entity = writer.entity();
  return OnStatus(entity, DDS_PUBLICATION_MATCHED_STATUS, [entity, callback = std::move(callback)] {
    dds_publication_matched_status_t status{};
    if (dds_get_publication_matched_status(entity, &status) < 0) return;
    callback({status.current_count, status.current_count_change, status.last_subscription_handle});
  });
}

void Waiter::Start() {
  PANGAEA_CHECK(!thread_.joinable());
  dds_set_guardcondition(stop_condition_.get(), false);
  thread_ = std::thread([this] { Run(); });
}

void Waiter::Stop() {
  if (!thread_.joinable()) return;
  dds_set_guardcondition(stop_condition_.get(), true);
  thread_.join();
}

void Waiter::Run() {
  for (;;) {
    std::array<dds_attach_t, kMostTriggers> triggered;
    const dds_return_t count = dds_waitset_wait(waitset_.get(), triggered.data(), triggered.size(), DDS_INFINITY);
    bool stopped = false;
    dds_read_guardcondition(stop_condition_.get(), &stopped);
    if (stopped || count < 0) return;
    const auto reported = std::min(static_cast<std::size_t>(count), triggered.size());
    for (std::size_t i = 0; i < reported; ++i) {
      const Handler& handler = handlers_[static_cast<std::size_t>(triggered[i])];
      if (handler.run) handler.run();
    }
  }
}

}  // namespace pangaea
