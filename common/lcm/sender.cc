#include "common/lcm/sender.h"

#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <utility>

namespace pangaea {
namespace {

constexpr std::int64_t kNanosecondsPerMicrosecond = 1000;

class LogSender final : public LcmSender {
 public:
  LogSender(std::unique_ptr<lcm::LogFile> log, std::string path) : log_(std::move(log)), path_(std::move(path)) {}

  Status Send(const std::string& channel, std::span<const std::byte> payload, std::int64_t stamp_ns) override {
    lcm::LogEvent event;
    event.eventnum = 0;  // counted by the log
    event.timestamp = stamp_ns / kNanosecondsPerMicrosecond;
    event.channel = channel;
    event.datalen = static_cast<std::int32_t>(payload.size());
    event.data = const_cast<std::byte*>(payload.data());  // only read
    return log_->writeEvent(&event) == 0 ? Status{} : CannotBeWritten();
  }
  Status Close() override { return std::fflush(log_->getFilePtr()) == 0 ? Status{} : CannotBeWritten(); }
  bool is_live() const override { return false; }

 private:
  Status CannotBeWritten() const { return Fail(ErrorCode::kUnavailable, path_ + ": cannot be written"); }

  std::unique_ptr<lcm::LogFile> log_;
  std::string path_;
};

class NetworkSender final : public LcmSender {
 public:
  explicit NetworkSender(std::unique_ptr<lcm::LCM> lcm) : lcm_(std::move(lcm)) {}

  Status Send(const std::string& channel, std::span<const std::byte> payload, std::int64_t) override {
    if (lcm_->publish(channel, payload.data(), static_cast<unsigned int>(payload.size())) == 0) return {};
    return Fail(ErrorCode::kUnavailable, "LCM: a message of channel " + channel + " cannot be sent");
  }
  Status Close() override { return {}; }
  bool is_live() const override { return true; }

 private:
  std::unique_ptr<lcm::LCM> lcm_;
};

}  // namespace

Result<std::unique_ptr<LcmSender>> LcmSender::Open(const LcmUrl& url) {
  if (url.log) {
    auto log = std::make_unique<lcm::LogFile>(url.log->string(), "w");
    if (!log->good()) return Fail(ErrorCode::kUnavailable, url.log->string() + ": cannot be written");
    return std::make_unique<LogSender>(std::move(log), url.log->string());
  }
  auto lcm = std::make_unique<lcm::LCM>(url.network);
  if (!lcm->good()) {
    return Fail(ErrorCode::kUnavailable, "LCM: " + url.network + " cannot be opened; is there a multicast route?");
  }
  return std::make_unique<NetworkSender>(std::move(lcm));
}

}  // namespace pangaea
