#include "common/lcm/receiver.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <utility>

namespace pangaea {
namespace {

// How long a wait for messages lasts before the stop is looked at again.
constexpr int kPatience_ms = 50;
// Messages of a channel that wait for us; beyond it LCM drops them. Five seconds of a camera at 20 Hz, which covers the
// start of the agent.
constexpr int kWaitingMessages = 100;
// What every event of a log begins with.
constexpr std::uint32_t kEventMark = 0xEDA1DA01;

LcmPayload PayloadOf(const void* data, std::size_t size) {
  const auto* first = static_cast<const std::byte*>(data);
  return {first, first + size};
}

class LogReceiver final : public LcmReceiver {
 public:
  LogReceiver(std::unique_ptr<lcm::LogFile> log, std::filesystem::path path, std::vector<std::string> channels)
      : log_(std::move(log)), path_(std::move(path)), channels_(std::move(channels)) {
    std::error_code ignored;
    size_ = std::filesystem::file_size(path_, ignored);
  }

  std::optional<Result<LcmMessage>> Next(const std::stop_token& stop) override {
    while (!stop.stop_requested()) {
      const std::int64_t begin = ftello(log_->getFilePtr());
      if (std::cmp_greater_equal(begin, size_)) return std::nullopt;
      const lcm::LogEvent* event = log_->readNextEvent();
      if (event == nullptr) {
        FindEventAfter(begin);
        return Result<LcmMessage>(Fail(ErrorCode::kCorrupt, path_.string() + ": truncated or damaged from octet " +
                                                                std::to_string(begin) + " on"));
      }
      if (std::ranges::find(channels_, event->channel) == channels_.end()) continue;
      return LcmMessage{event->channel, PayloadOf(event->data, static_cast<std::size_t>(event->datalen))};
    }
    return std::nullopt;
  }
  bool is_live() const override { return false; }

 private:
  // An event that makes no sense may claim any length, so that the library's reader would skip all that follows it.
  void FindEventAfter(std::int64_t begin) {
    FILE* file = log_->getFilePtr();
    std::clearerr(file);
    fseeko(file, begin + 1, SEEK_SET);
    std::uint32_t latest = 0;
    for (int octet = std::getc(file); octet != EOF; octet = std::getc(file)) {
      latest = latest << 8U | static_cast<std::uint32_t>(octet);
      if (latest != kEventMark) continue;
      fseeko(file, -static_cast<std::int64_t>(sizeof(kEventMark)), SEEK_CUR);
      return;
    }
  }

  std::unique_ptr<lcm::LogFile> log_;
  std::filesystem::path path_;
  std::vector<std::string> channels_;
  std::uintmax_t size_ = 0;
};

class NetworkReceiver final : public LcmReceiver {
 public:
  NetworkReceiver(std::unique_ptr<lcm::LCM> lcm, const std::vector<std::string>& channels) : lcm_(std::move(lcm)) {
    for (const std::string& channel : channels) {
      lcm_->subscribe(channel, &NetworkReceiver::Take, this)->setQueueCapacity(kWaitingMessages);
    }
  }

  std::optional<Result<LcmMessage>> Next(const std::stop_token& stop) override {
    while (arrived_.empty()) {
      if (stop.stop_requested() || broken_) return std::nullopt;
      if (lcm_->handleTimeout(kPatience_ms) >= 0) continue;
      broken_ = true;
      return Result<LcmMessage>(Fail(ErrorCode::kUnavailable, "LCM: the network cannot be read any more"));
    }
    LcmMessage message = std::move(arrived_.front());
    arrived_.pop_front();
    return message;
  }
  bool is_live() const override { return true; }

 private:
  void Take(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    arrived_.push_back({channel, PayloadOf(buffer->data, buffer->data_size)});
  }

  std::unique_ptr<lcm::LCM> lcm_;
  std::deque<LcmMessage> arrived_;  // one at most: a call of handleTimeout delivers one message
  bool broken_ = false;
};

}  // namespace

Result<std::unique_ptr<LcmReceiver>> LcmReceiver::Open(const LcmUrl& url, const std::vector<std::string>& channels) {
  if (url.log) {
    std::error_code error;
    const bool is_file = std::filesystem::is_regular_file(*url.log, error);
    auto log = is_file ? std::make_unique<lcm::LogFile>(url.log->string(), "r") : nullptr;
    if (log == nullptr || !log->good()) {
      return Fail(ErrorCode::kNotFound, url.log->string() + ": there is no such LCM log, or it cannot be read");
    }
    return std::make_unique<LogReceiver>(std::move(log), *url.log, channels);
  }
  auto lcm = std::make_unique<lcm::LCM>(url.network);
  if (!lcm->good()) {
    return Fail(ErrorCode::kUnavailable, "LCM: " + url.network + " cannot be opened; is there a multicast route?");
  }
  return std::make_unique<NetworkReceiver>(std::move(lcm), channels);
}

}  // namespace pangaea
